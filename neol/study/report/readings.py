"""The page docs/readings.md: readings that reproduce the paper's baselines (docs/readings-plan.md).

`readings.md.j2` is its text. `--confirm` prints the arguments of the calls of snakemake that run
the confirmation instead.
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from neol.base.ending import exit_codes
from neol.base.errors import UserError
from neol.base.files import write_atomically
from neol.network.rules import BASELINES
from neol.pictures.labels import method_label, task_label
from neol.pictures.style import write_picture
from neol.spec.configuration import READINGS, load_configuration
from neol.spec.readings import BASE_READING, DEFAULT_READING, read_reading
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.search import CONFIRMATION, SCREENING, calls, candidates
from neol.study.outcomes.baselines import (
    COUNTINGS,
    QUANTITIES,
    TASK,
    comparisons,
    paper_number,
    ranking,
    to_confirm,
)
from neol.study.report.common import render
from neol.study.report.multiverse import Multiverse, picture_name
from neol.study.report.readings_picture import readings_picture
from neol.study.report.reward_scales import reward_scales, what_learning_adds
from neol.study.report.unused_numbers import unused_numbers

NUMBERS = [(method, quantity) for method in BASELINES for quantity in QUANTITIES]
"""The paper's four numbers of the baselines, each with a standard deviation."""


class Stage:
    """The runs of the screening or of the confirmation, compared with the paper."""

    def __init__(self, budget: str, readings: Sequence[str], results: Path) -> None:
        self.budget = budget
        self.seeds = len(load_configuration(budget).budget.seeds_of(TASK))
        self.table, self.sources, self.core_hours = comparisons(readings, budget, results)
        self.ranked = ranking(self.table, self.seeds)
        """Readings that have all their runs."""

    @property
    def runs(self) -> int:
        return sum(len(source.runs) for source in self.sources)

    @property
    def complete(self) -> list[str]:
        """Return the readings that have all their runs, nearest first."""
        return list(dict.fromkeys(self.ranked["reading"]))

    def numbers(self) -> list[list[str]]:
        """Return a head, a row for each complete reading, nearest first, and the paper's row.

        Each has its distance, how many of the paper's eight numbers fit, and its own four means,
        with the best of the generation and so far; bold where compatible.
        """
        rows = {_place(row): row for row in self.table.to_dict("records")}
        ranked = self.ranked.to_dict("records")
        judged = {(row["reading"], row["counting"]): row for row in ranked}
        distances = [f"distance, {counting}" for counting in COUNTINGS]
        head = ["reading", *distances, "numbers that fit"]
        lines = [head + [f"{method_label(method)}, {quantity}" for method, quantity in NUMBERS]]
        for reading in self.complete:
            distances = [f"{judged[reading, each]['distance']:.1f}" for each in COUNTINGS]
            fitting = " / ".join(_fitting(judged[reading, each]) for each in COUNTINGS)
            line = [f"`{reading}`", *distances, fitting]
            for number in NUMBERS:
                means = [_mean(rows[reading, counting, *number]) for counting in COUNTINGS]
                line.append(" / ".join(means))
            lines.append(line)
        paper = [paper_number(method, quantity) for method, quantity in NUMBERS]
        return [
            *lines,
            ["the paper", "", "", "", *(f"{mean:.0f} ± {sd:.0f}" for mean, sd in paper)],
        ]

    def compatible(self) -> list[str]:
        """Return the compatible readings, each with its counting, nearest first."""
        chosen = self.ranked[self.ranked["compatible"]]
        return [f"`{row.reading}` (best {row.counting})" for row in chosen.itertuples()]

    def nearest(self) -> str:
        """Return the nearest reading with its distance; empty without readings."""
        if self.ranked.empty:
            return ""
        row = self.ranked.iloc[0]
        return f"`{row['reading']}` (best {row['counting']}), {row['distance']:.1f} SDs away"

    def unexplained(self) -> list[str]:
        """Return the paper's numbers that no complete reading is compatible with, by counting."""
        here = self.table[self.table["reading"].isin(self.complete)]
        places = ["method", "quantity", "counting"]
        explained = here.groupby(places, sort=False)["compatible"].any().reset_index()
        return [
            f"{method_label(row['method'])}, {row['quantity']} best {row['counting']}"
            for row in explained.to_dict("records")
            if not row["compatible"]
        ]


def _place(row: Mapping[Any, Any]) -> tuple[str, str, str, str]:
    return row["reading"], row["counting"], row["method"], row["quantity"]


def _mean(number: Mapping[Any, Any]) -> str:
    return _marked(f"{number['mean']:.0f} ± {number['sd']:.0f}", number)


def _fitting(judged: Mapping[Any, Any]) -> str:
    return _marked(str(judged["fitting"]), judged)


def _marked(text: str, judged: Mapping[Any, Any]) -> str:
    """Return a text in bold if what it says is compatible with the paper."""
    return f"**{text}**" if judged["compatible"] else text


class Page(NamedTuple):
    """The page as Markdown, and the content of its pictures."""

    text: str
    decisive: Stage
    """The stage that decides: the confirmation if it has complete readings."""
    multiverse: Multiverse


def page(results: Path = RESULTS) -> Page:
    """Return the page for the present records."""
    multiverse = Multiverse(results)
    order = list(candidates())
    screening = Stage(SCREENING, order, results)
    chosen = to_confirm(screening.ranked, BASE_READING)
    confirmation = Stage(CONFIRMATION, order, results)
    decisive = confirmation if confirmation.complete else screening
    text = render(
        "readings.md.j2",
        screening=screening,
        confirmation=confirmation,
        chosen=[f"`{name}`" for name in chosen],
        decisive=decisive,
        compatible=", ".join(decisive.compatible()),
        nearest=decisive.nearest(),
        unexplained=decisive.unexplained(),
        not_reached=[f"`{name}`" for name in order if name not in screening.complete],
        readings=[_described(name) for name in order],
        default=DEFAULT_READING,
        unused=unused_numbers(DEFAULT_READING, results),
        reward_scales=reward_scales(DEFAULT_READING, results),
        what_learning_adds=what_learning_adds(DEFAULT_READING, results),
        multiverse=multiverse,
        picture_name=picture_name,
        task_label=task_label,
    )
    return Page(text, decisive, multiverse)


def _described(name: str) -> dict[str, Any]:
    reading = read_reading(READINGS, name)
    return {"name": name, **reading.model_dump()}


def write_page(output: Path, results: Path = RESULTS) -> None:
    """Write the page, and next to it pictures of the readings that have all their runs.

    Raises UserError if no candidate has all its runs.
    """
    text, stage, multiverse = page(results)
    if not stage.complete:
        raise UserError(f"{results}: no candidate of the search has all its runs; `make search`")
    nearest = {name: place for place, name in enumerate(stage.complete)}
    drawn = stage.table[stage.table["reading"].isin(nearest)]
    drawn = drawn.sort_values("reading", key=lambda names: names.map(nearest), kind="stable")
    write_atomically(output, text.encode())
    write_picture(readings_picture(drawn), output.with_suffix(".png"))
    if multiverse.tasks:
        multiverse.write(output.parent)


def confirmation_calls(results: Path = RESULTS) -> list[str]:
    """Return the arguments of the calls of snakemake that make the confirmation's records."""
    screening = Stage(SCREENING, list(candidates()), results)
    return calls(CONFIRMATION, to_confirm(screening.ranked, BASE_READING))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m neol.study.report.readings")
    parser.add_argument("output", type=Path, nargs="?", default=Path("docs/readings.md"))
    parser.add_argument(
        "--confirm", action="store_true", help="print the calls that run the confirmation"
    )
    arguments = parser.parse_args()
    with exit_codes():
        if arguments.confirm:
            print(*confirmation_calls(), sep="\n")
        else:
            write_page(arguments.output)
