"""What the results say in words, for the page docs/results.md and for the paper.

Every sentence is made of cells of a budget's tables and says no more than the interval beside it: a
comparison whose interval holds "no difference" was not told apart.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import pandas as pd

from neol.analysis.claims import (
    NO_COMMON_RANGE,
    NOT_IN_BUDGET,
    TOO_FEW,
    TOO_SHORT,
    UNEQUAL_TASKS,
)
from neol.analysis.labels import method_label, task_label, three_figures
from neol.analysis.reference import SEEDS as PAPER_SEEDS
from neol.analysis.score import PAPER_GENERATIONS
from neol.analysis.statistics import ALPHA
from neol.campaign import Block, cells, run_specs
from neol.cost import run_seconds
from neol.report.costs import SECONDS_IN_AN_HOUR
from neol.sensitivity import BASELINE
from neol.spec import Configuration, load_configuration

FITNESS, ABLATION = "final fitness", "ablation, final fitness"
AGAINST = {FITNESS: "NEAT", ABLATION: "NEAT (w/o)"}
"""The comparisons of beyond_effects.csv that are told, and with whom each is."""
SEEDS = (PAPER_SEEDS, 100, 300, 1000)
"""Where seeds are what open claims lack, these budgets are looked at."""


def told_apart(effects: pd.DataFrame, comparison: str) -> list[str]:
    """For each task, and for all together, which rules end above or below NEAT: A12."""
    against = AGAINST[comparison]
    sentences = []
    for task, rows in effects[effects["comparison"] == comparison].groupby("task", sort=False):
        sides: dict[str, list[str]] = {}
        for row in rows.to_dict("records"):
            share = f" {_share(row)}" if row["seeds"] else ""
            sides.setdefault(_side(row), []).append(f"{method_label(row['method'])}{share}")
        place = "All tasks together" if task == "all" else task_label(str(task))
        said = "; ".join(f"{', '.join(some)} {side} {against}" for side, some in sides.items())
        sentences.append(f"{place}: {said}.")
    return sentences


def after_correction(effects: pd.DataFrame) -> str:
    """How many of the declared tests remain significant."""
    tested = effects.dropna(subset="p_holm")
    significant = tested[tested["p_holm"] < ALPHA]
    named = "; ".join(
        f"{row['comparison']}, {task_label(row['task'])}, {method_label(row['method'])}"
        for row in significant.to_dict("records")
    )
    return (
        f"Of {len(tested)} one-sided tests of the declared family, {len(significant)} have p < "
        f"{ALPHA} after Holm's correction{f': {named}' if named else ''}."
    )


def flattered(selection: pd.DataFrame) -> list[str]:
    """For each task how far the champions' training maxima lie above what they get again."""
    sentences = []
    for task, rows in selection.dropna(subset="mean").groupby("task", sort=False):
        low, high = map(three_figures, (rows["mean"].min(), rows["mean"].max()))
        sentences.append(f"{task_label(str(task))}: {low} to {high}.")
    return sentences


def told_by_sensitivity(table: pd.DataFrame) -> list[str]:
    """For each task which readings of the paper were told apart from the baseline's, and how."""
    varied = table[(table["variant"] != BASELINE) & (table["pairs"] > 0)]
    if varied.empty:
        return ["None of the study's runs is there."]
    differ = varied[(varied["low"] > 0.5) | (varied["high"] < 0.5)]
    sentences = []
    for task, rows in varied.groupby("task", sort=False):
        named = ", ".join(
            f"{row['variant']} ({method_label(row['method'])}) {_share(row)}"
            for row in differ[differ["task"] == task].to_dict("records")
        )
        sentences.append(
            f"{task_label(str(task))}: {named or 'none'}, of {len(rows)} that were tried."
        )
    return [
        *sentences,
        f"All together: {len(differ)} of {len(varied)}; if no reading mattered, about "
        f"{ALPHA * len(varied):.0f} would be by chance.",
    ]


class Step(NamedTuple):
    """What would decide some of the open claims."""

    takes: str
    claims: int
    core_hours: str


def steps(ledger: pd.DataFrame, configuration: Configuration) -> list[Step]:
    """What the open claims lack, and what it costs; a claim counts where it lacks the most."""
    budget, paper = configuration.budget, load_configuration("paper")
    more = [seeds for seeds in SEEDS if seeds > budget.seeds]
    takes: dict[str | float, tuple[str, float | None]] = {
        "runs": ("the rest of this budget's runs", None),
        **{
            seeds: (f"{seeds} seeds instead of {budget.seeds}", core_hours(configuration, seeds))
            for seeds in more
        },
        math.inf: ("more seeds than that: little or no difference is seen here", None),
        "generations": (
            f"{PAPER_GENERATIONS} generations",
            core_hours(configuration, budget.seeds, PAPER_GENERATIONS),
        ),
        "cells": (
            "cells that this budget does not have: the paper's budget",
            core_hours(paper, paper.budget.seeds),
        ),
    }
    counts = Counter(_lack(parts, more) for _, parts in open_parts(ledger))
    return [
        Step(text, counts[lack], "--" if hours is None else three_figures(hours))
        for lack, (text, hours) in takes.items()
        if counts[lack]
    ]


def core_hours(
    configuration: Configuration, seeds: int, generations: int | None = None
) -> float | None:
    """What a budget's grid costs by measurement, held-out episodes left out; None if unknown."""
    first = [
        run_specs(configuration, Block(configuration.budget.name, cell, 0, 0))[0]
        for cell in cells(configuration)
    ]
    seconds = [
        run_seconds(spec.model_copy(update={"generations": generations or spec.generations}))
        for spec in first
    ]
    return None if None in seconds else seeds * sum(filter(None, seconds)) / SECONDS_IN_AN_HOUR


def open_parts(ledger: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The undecided parts of each undecided claim."""
    parts = ledger[(ledger["verdict"] == "undecided") & (ledger["part_verdict"] == "undecided")]
    for claim, some in parts.groupby("claim", sort=False):
        yield str(claim), some


def _lack(parts: pd.DataFrame, more: Sequence[int]) -> str | float:
    """What a claim's open parts need the most: one of `steps`."""
    reasons = set(parts["reason"].dropna())
    if NOT_IN_BUDGET in reasons:
        return "cells"
    if reasons & {TOO_SHORT, NO_COMMON_RANGE, UNEQUAL_TASKS}:
        return "generations"
    if reasons - {TOO_FEW}:
        return "runs"
    needed = _seeds_needed(parts)
    return next((seeds for seeds in more if needed <= seeds), math.inf)


def _seeds_needed(parts: pd.DataFrame) -> float:
    """Of the part that needs the most; a claim of no difference needs the paper's."""
    return float(parts["seeds_needed"].fillna(PAPER_SEEDS).max())


def lacks_of_open(ledger: pd.DataFrame) -> dict[str, str]:
    """What each undecided claim lacks, by its name."""
    return {claim: lacks(parts) for claim, parts in open_parts(ledger)}


def lacks(parts: pd.DataFrame) -> str:
    """What a claim's open parts need."""
    reasons = list(dict.fromkeys(parts["reason"].dropna()))
    needed = _seeds_needed(parts)
    if reasons:
        return ", ".join(reasons)
    return f"{needed:.0f} seeds" if needed <= SEEDS[-1] else f"more than {SEEDS[-1]} seeds"


def _side(row: Mapping[Any, Any]) -> str:
    """What an interval of A12 lets one say."""
    if not row["seeds"]:
        return "cannot be compared with"
    return "above" if row["low"] > 0.5 else "below" if row["high"] < 0.5 else "not told apart from"


def _share(row: Mapping[Any, Any]) -> str:
    return f"{row['a12']:.2f} [{row['low']:.2f}, {row['high']:.2f}]"
