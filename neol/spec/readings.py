"""Readings: named sets of constants where the paper is silent, one file each in `config/readings/`.

`config/base.yaml` is the reading `worked_example`. A label is a reading's name, optionally with
changed constants: `first`, or `first+plasticity.reward_scale=0.1`. It is part of paths of records.
"""

import json
import re
from pathlib import Path
from typing import Any

from neol.base.errors import UserError, hint
from neol.spec.sources import Overlay
from neol.spec.types import NAME, Model, Text

BASE_READING = "worked_example"
"""Reading that is config/base.yaml itself."""
DEFAULT_READING = "rare_mutation"
"""Reading of runs that name none: the one that docs/readings.md arrives at."""
FIRST_READING = "first"
"""Reading of records that name none, because they are older than readings."""


class Reading(Model):
    """A reading of the paper; its name is that of its file."""

    summary: Text
    """What distinguishes this reading, in one sentence."""
    speaks_for: Text
    """Evidence for it in the paper or its numbers."""
    speaks_against: Text
    """Evidence against it."""
    constants: dict[Text, dict[Text, Any]]
    """Changed constants by section of config/base.yaml; all others keep their values."""


def readings(folder: Path) -> list[str]:
    """Return the names of the readings in a folder."""
    return sorted(path.stem for path in folder.glob("*.yaml"))


def read_reading(folder: Path, name: str) -> Reading:
    """Return a reading of a folder.

    Raises UserError for one that is missing, damaged, or sets the budget.
    """
    known = readings(folder)
    if name not in known:
        several = "; give one reading" if re.search(r"[\s,]", name) else ""
        raise UserError(f'unknown reading "{name}"{several}{hint(name, known)}')
    if not re.fullmatch(NAME, name):
        raise UserError(
            f"{folder / name}.yaml: cannot be part of a path; name it with letters, digits, _ . -"
        )
    overlay = Overlay.of(folder / f"{name}.yaml")
    reading = overlay.parse(Reading)
    if "budget" in reading.constants:
        place = overlay.place(("constants", "budget"))
        raise UserError(f"{place}: a reading sets no budget; --budget chooses it")
    return reading


def split_label(label: str) -> tuple[str, list[str]]:
    """Split a label into a reading's name and its changes, like "neat.elitism=3".

    Raises UserError where a change sets the budget.
    """
    name, *changes = re.split(r"\+(?=[A-Za-z_])", label)
    for change in changes:
        if re.match(r"\s*budget\b", change):
            raise UserError(f'"{change}": a reading sets no budget; --budget chooses it')
    return name, changes


def with_changes(label: str, changes: object) -> str:
    """Add changes to a label: "first" and "a.b=1,c.d=2" give "first+a.b=1+c.d=2"."""
    return "+".join([label, *filter(None, str(changes or "").split(","))])


def make_label(name: str, changes: dict[str, Any]) -> str:
    """Return the label of a reading with changed constants; their order does not matter.

    Raises UserError for a value that cannot be part of a path.
    """
    words = [name]
    for key, value in sorted(changes.items()):
        word = f"{key}={value if isinstance(value, str) else json.dumps(value)}"
        if not re.fullmatch(r"[\w.+=-]+", word):
            raise UserError(f'"{word[:60]}" cannot be part of a path; write a reading of its own')
        words.append(word)
    return "+".join(words)
