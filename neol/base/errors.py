"""The one kind of error that is the user's to mend, and what is said that is none."""

import difflib
from collections.abc import Callable, Iterable
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

NOTICE = "neol: note: "
"""How a line of ours begins that tells of no error."""
INTERRUPTED, TERMINATED = "interrupted", "terminated"
"""How what follows `neol: ` begins where a run was stopped, which is no error either."""


class UserError(Exception):
    """Something outside neol is wrong: one line that says what, where, and how to mend it.

    Mostly the input; else what it runs on (a full disk) or with (an environment that raises).

    The command line prints the line and exits with 2; a stack trace is left to our own bugs.
    What a terminal would not show as it is, such as a line's end in a name, is escaped.
    """

    def __init__(self, line: str) -> None:
        super().__init__("".join(c if c.isprintable() else repr(c)[1:-1] for c in line))


_PLAIN_WORDS = {
    "Input should be": "must be",
    "Tuple should have at least 1 item after validation, not 0": "must not be empty",
    "an object": "a mapping of keys to values",
    "a valid array": "a list",
}


def one_line(
    error: ValidationError,
    root: object,
    place: Callable[[tuple[str, ...]], str] = ".".join,
) -> str:
    """The first of the errors, an unknown key before what it left missing.

    `root` is the type that was asked for, a model or a dictionary of them; `place` names a path
    of keys so that the user finds it.
    """
    first = min(error.errors(), key=lambda each: each["type"] != "extra_forbidden")
    loc = tuple(str(part) for part in first["loc"] if part != "[key]")
    if first["type"] == "extra_forbidden":
        return f"{place(loc)}: unknown key{hint(loc[-1], _keys(root, loc[:-1]))}"
    if first["type"] == "missing":
        return f"{place(loc)}: is missing"
    problem = first["msg"]
    for pydantics, plain in _PLAIN_WORDS.items():
        problem = problem.replace(pydantics, plain)
    return f"{place(loc)} = {first['input']!r}: {problem}" if loc else problem


def _keys(root: object, loc: tuple[str, ...]) -> list[str]:
    """The keys that the types allow at a place, without those that no file states."""
    place: Any = root
    for key in loc:
        is_model = isinstance(place, type) and issubclass(place, BaseModel)
        if is_model:
            place = place.model_fields[key].annotation
        else:  # tuple[Item, ...] or dict[str, Item]
            first, second = get_args(place)
            place = first if second is Ellipsis else second
    return [key for key in place.model_fields if key not in ("name", "reading")]


def hint(word: object, allowed: Iterable[str]) -> str:
    """What was perhaps meant, and all that is allowed."""
    allowed = list(allowed)
    near = difflib.get_close_matches(str(word), allowed, n=1)
    meant = f', did you mean "{near[0]}"?' if near else ""
    return f"{meant} (allowed: {', '.join(allowed)})"
