"""Errors that the user can fix, and the opening words of messages that report no error."""

import difflib
from collections.abc import Callable, Iterable
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

NOTICE = "neol: note: "
"""Opening words of a line that informs and reports no error."""
INTERRUPTED, TERMINATED = "interrupted", "terminated"
"""First words after `neol: ` where a signal stopped a run, which is no error either."""


FOREIGN = (Exception, SystemExit)
"""Exceptions of foreign code; Ctrl-C is not among them."""


def printable(line: str) -> str:
    """Return a line with all unprintable characters escaped."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in line)


class UserError(Exception):
    """Error outside neol (input, disk, environment): one line says what, where and how to fix it.

    The command line prints the line and exits with 2; only an internal error shows a stack trace.
    Characters that a terminal cannot show, such as a line break in a name, are escaped.
    """

    def __init__(self, line: str) -> None:
        super().__init__(printable(line))


def described(error: BaseException) -> str:
    """Describe an error of foreign code in one line: its type and the beginning of its text."""
    text = " ".join(str(error).split())[:200]
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


MANY_ERRORS = 10_000
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
    """Return the first error as one line; an unknown key comes before a missing one.

    `root` is the expected type, a model or a dictionary of models; `place` names a path of keys
    so that the user finds it.
    """
    if error.error_count() > MANY_ERRORS:  # each would be made, of a file that is not ours
        return f"{error.error_count():,} values are not allowed"
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
    """Return the keys that the types allow at a place, without those that files never state."""
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
    """Return the closest allowed word as a question, and the list of all allowed words."""
    allowed = list(allowed)
    near = difflib.get_close_matches(str(word), allowed, n=1)
    meant = f', did you mean "{near[0]}"?' if near else ""
    return f"{meant} (allowed: {', '.join(allowed)})"
