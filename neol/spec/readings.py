"""Readings: named sets of constants where the paper is silent, a file each in `config/readings/`.

`config/base.yaml` is the reading `default`. A label names a reading, with further constants that
are changed: `first`, or `first+plasticity.reward_scale=0.1`. It is part of the paths of records.
"""

import json
import re
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from neol.base.errors import UserError, hint, one_line
from neol.spec.sources import Overlay
from neol.spec.types import NAME, Model, Text

DEFAULT_READING = "default"
"""The constants of config/base.yaml."""
FIRST_READING = "first"
"""That of all records that name none: they are older than readings."""


class Reading(Model):
    """A reading of the paper, but for its name, which is its file's."""

    summary: Text
    """What distinguishes it, in one sentence."""
    speaks_for: Text
    """What in the paper, or in its numbers, speaks for it."""
    speaks_against: Text
    """What speaks against it."""
    constants: dict[Text, dict[Text, Any]]
    """By section of config/base.yaml; all others are as there."""


def readings(folder: Path) -> list[str]:
    """The names of the readings in a folder."""
    return sorted(path.stem for path in folder.glob("*.yaml"))


def read_reading(folder: Path, name: str) -> Reading:
    """A reading of a folder.

    Raises UserError for one that is not there, that is damaged, or that sets the budget.
    """
    known = readings(folder)
    if name not in known:
        several = "; give one reading" if re.search(r"[\s,]", name) else ""
        raise UserError(f'unknown reading "{name}"{several}{hint(name, known)}')
    if not re.fullmatch(NAME, name):
        raise UserError(
            f"{folder / name}.yaml: cannot be part of a path; name it with letters, digits, _ . -"
        )
    overlay = Overlay()
    overlay.add_file(folder / f"{name}.yaml")
    try:
        reading = Reading.model_validate_json(json.dumps(overlay.values))
    except ValidationError as error:
        raise UserError(one_line(error, Reading, overlay.place)) from None
    if "budget" in reading.constants:
        place = overlay.place(("constants", "budget"))
        raise UserError(f"{place}: a reading sets no budget; --budget chooses it")
    return reading


def split_label(label: str) -> tuple[str, list[str]]:
    """A reading's name, and the constants that are changed: like "neat.elitism=3".

    Raises UserError where the budget is among them.
    """
    name, *changes = re.split(r"\+(?=[A-Za-z_])", label)
    for change in changes:
        if re.match(r"\s*budget\b", change):
            raise UserError(f'"{change}": a reading sets no budget; --budget chooses it')
    return name, changes


def with_changes(label: str, changes: object) -> str:
    """A label with changes more: of "first" and "a.b=1,c.d=2" it is "first+a.b=1+c.d=2"."""
    return "+".join([label, *filter(None, str(changes or "").split(","))])


def make_label(name: str, changes: dict[str, Any]) -> str:
    """The one label of a reading and changed constants, whatever their order.

    Raises UserError for a value that cannot be part of a path.
    """
    words = [name]
    for key, value in sorted(changes.items()):
        word = f"{key}={value if isinstance(value, str) else json.dumps(value)}"
        if not re.fullmatch(r"[\w.+=-]+", word):
            raise UserError(f'"{word[:60]}" cannot be part of a path; write a reading of its own')
        words.append(word)
    return "+".join(words)
