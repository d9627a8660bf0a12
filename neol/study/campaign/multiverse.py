"""The multiverse: every question under every reading of a declared grid, and its runs.

Its plan is docs/readings-plan.md. `python -m neol.study.campaign.multiverse` prints the arguments
of one call of snakemake for each set of constants.
"""

import itertools
from functools import cache
from pathlib import Path

from neol.base.ending import exit_codes
from neol.base.errors import UserError
from neol.spec.configuration import CONFIG, Configuration, load_configuration
from neol.spec.readings import BASE_READING, with_changes
from neol.spec.sources import Overlay
from neol.spec.types import MethodName, Model, Several, Text
from neol.study.campaign.grid import RESULTS, Block, blocks
from neol.study.campaign.search import workflow_calls

GRID = CONFIG / "search" / "multiverse.yaml"
BUDGET = "multiverse"
Universe = dict[str, str]
"""A reading of the grid: one option for each choice."""


class Choice(Model):
    """A part of the paper that can be read in several ways."""

    methods: Several[MethodName]
    """Methods that the choice concerns."""
    options: dict[Text, tuple[Text, ...]]
    """Constants that each option sets, by the option's name; like neat.elitism=3."""


def choices() -> dict[str, Choice]:
    """Return the choices by name. Raises UserError for an invalid file."""
    return _choices(GRID)


@cache
def _choices(file: Path) -> dict[str, Choice]:
    return Overlay.of(file).parse(dict[str, Choice])


def universes() -> list[Universe]:
    """Return every reading of the grid in the order of runs; the last choice changes fastest."""
    found = choices()
    options = itertools.product(*(choice.options for choice in found.values()))
    return [dict(zip(found, each, strict=True)) for each in options]


def configuration(universe: Universe, method: str) -> Configuration:
    """Return the budget's configuration under those choices of a reading that concern a method.

    Raises UserError for a constant or a value that is not allowed.
    """
    concerning = {name: each for name, each in choices().items() if method in each.methods}
    constants = [text for name, each in concerning.items() for text in each.options[universe[name]]]
    try:
        return _configuration(with_changes(BASE_READING, ",".join(constants)))
    except UserError as error:
        raise UserError(f"{GRID.parent.name}/{GRID.name}: {error}") from None


@cache
def _configuration(reading: str) -> Configuration:
    return load_configuration(BUDGET, reading=reading)


def method_blocks(universe: Universe, method: str) -> list[Block]:
    """Return the records of a method's runs under a reading."""
    return [
        block for block in blocks(configuration(universe, method)) if block.cell.method == method
    ]


def complete(task: str, results: Path = RESULTS) -> list[Universe]:
    """Return the readings under which all runs of a task have their records."""
    methods = load_configuration(BUDGET).budget.methods
    return [
        universe
        for universe in universes()
        if all(
            (results / block.record).exists()
            for method in methods
            for block in method_blocks(universe, method)
            if block.cell.task == task
        )
    ]


def calls() -> list[str]:
    """Return the arguments of the calls of snakemake that make all records, each once."""
    wanted: dict[str, dict[Block, None]] = {}
    for universe in universes():
        for method in load_configuration(BUDGET).budget.methods:
            records = wanted.setdefault(configuration(universe, method).reading, {})
            records |= dict.fromkeys(method_blocks(universe, method))
    return workflow_calls(BUDGET, wanted)


if __name__ == "__main__":
    with exit_codes():
        print(*calls(), sep="\n")
