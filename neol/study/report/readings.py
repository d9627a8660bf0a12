"""The page docs/readings.md: which readings make the paper's baselines, by docs/readings-plan.md.

`readings.md.j2` is its text. `--confirm` prints instead what the confirmation is to run: the
arguments of calls of snakemake.
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from neol.base.ending import exit_codes
from neol.base.errors import UserError
from neol.base.files import write_atomically
from neol.pictures.labels import method_label
from neol.pictures.style import write_picture
from neol.spec.configuration import READINGS, load_configuration
from neol.spec.readings import DEFAULT_READING, read_reading
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.search import BASELINES, CONFIRMATION, SCREENING, calls, candidates
from neol.study.outcomes.baselines import (
    QUANTITIES,
    comparisons,
    paper_number,
    ranking,
    to_confirm,
)
from neol.study.report.common import render
from neol.study.report.readings_picture import readings_picture

NUMBERS = [(method, quantity) for method in BASELINES for quantity in QUANTITIES]
"""What the paper prints of the baselines, each with its standard deviation."""


class Stage:
    """What there is of the screening or of the confirmation."""

    def __init__(self, budget: str, readings: Sequence[str], results: Path) -> None:
        self.budget = budget
        self.seeds = load_configuration(budget).budget.seed_count
        self.table, self.sources, self.core_hours = comparisons(readings, budget, results)
        self.ranked = ranking(self.table, self.seeds)
        """The readings all of whose runs are there."""

    @property
    def runs(self) -> int:
        return sum(len(source.runs) for source in self.sources)

    @property
    def complete(self) -> list[str]:
        """Readings all of whose runs are there, the nearest first."""
        return list(dict.fromkeys(self.ranked["reading"]))

    def numbers(self) -> list[list[str]]:
        """A head, a row for each complete reading and counting, and the paper's.

        A row has a distance, and the means of the four numbers, bold where compatible.
        """
        rows = {_place(row): row for row in self.table.to_dict("records")}
        head = ["reading", "best", "distance", "compatible"]
        lines = [head + [f"{method_label(method)}, {quantity}" for method, quantity in NUMBERS]]
        for each in self.ranked.to_dict("records"):
            numbers = [rows[each["reading"], each["counting"], *number] for number in NUMBERS]
            verdict = "yes" if each["compatible"] else "no"
            line = [f"`{each['reading']}`", each["counting"], f"{each['distance']:.1f}", verdict]
            lines.append([*line, *map(_mean, numbers)])
        paper = (paper_number(method, quantity) for method, quantity in NUMBERS)
        return [
            *lines,
            ["the paper", "", "", "", *(f"{mean:.0f} ± {sd:.0f}" for mean, sd in paper)],
        ]

    def compatible(self) -> list[str]:
        """The compatible readings, each with its counting, the nearest first."""
        chosen = self.ranked[self.ranked["compatible"]]
        return [f"`{row.reading}` (best {row.counting})" for row in chosen.itertuples()]

    def unexplained(self) -> list[str]:
        """The paper's numbers that no complete reading is compatible with, by counting."""
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
    text = f"{number['mean']:.0f} ± {number['sd']:.0f}"
    return f"**{text}**" if number["compatible"] else text


def page(results: Path = RESULTS) -> tuple[str, Stage]:
    """The page as Markdown, and the stage that decides: the confirmation where it has runs."""
    order = list(candidates())
    screening = Stage(SCREENING, order, results)
    chosen = to_confirm(screening.ranked, DEFAULT_READING)
    confirmation = Stage(CONFIRMATION, chosen, results)
    decisive = confirmation if confirmation.complete else screening
    text = render(
        "readings.md.j2",
        screening=screening,
        confirmation=confirmation,
        chosen=[f"`{name}`" for name in chosen],
        decisive=decisive,
        compatible=", ".join(decisive.compatible()),
        unexplained=decisive.unexplained(),
        not_reached=[f"`{name}`" for name in order if name not in screening.complete],
        readings=[_described(name) for name in order],
    )
    return text, decisive


def _described(name: str) -> dict[str, Any]:
    reading = read_reading(READINGS, name)
    return {"name": name, **reading.model_dump()}


def write_page(output: Path, results: Path = RESULTS) -> None:
    """Write the page and beside it its picture, of the readings whose runs are all there.

    Raises UserError where no candidate has all its runs.
    """
    text, stage = page(results)
    if not stage.complete:
        raise UserError(f"{results}: no candidate of the search has all its runs; `make search`")
    nearest = {name: place for place, name in enumerate(stage.complete)}
    drawn = stage.table[stage.table["reading"].isin(nearest)]
    drawn = drawn.sort_values("reading", key=lambda names: names.map(nearest), kind="stable")
    write_atomically(output, text.encode())
    write_picture(readings_picture(drawn), output.with_suffix(".png"))


def confirmation_calls(results: Path = RESULTS) -> list[str]:
    """The arguments of the calls of snakemake that make the confirmation's records."""
    screening = Stage(SCREENING, list(candidates()), results)
    return calls(CONFIRMATION, to_confirm(screening.ranked, DEFAULT_READING))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m neol.study.report.readings")
    parser.add_argument("output", type=Path, nargs="?", default=Path("docs/readings.md"))
    parser.add_argument("--confirm", action="store_true", help="print what is to be confirmed")
    arguments = parser.parse_args()
    with exit_codes():
        if arguments.confirm:
            print(*confirmation_calls(), sep="\n")
        else:
            write_page(arguments.output)
