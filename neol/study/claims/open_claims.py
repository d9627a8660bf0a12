"""What open claims lack, and what it would cost."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import pandas as pd

from neol.pictures.labels import three_figures
from neol.spec.configuration import Configuration, load_configuration
from neol.study.campaign.cost import run_seconds
from neol.study.campaign.grid import Block, cells, home, run_specs
from neol.study.campaign.shown import chosen_tasks
from neol.study.claims.claims import (
    NO_COMMON_RANGE,
    NO_SUCH_CELL,
    TOO_FEW,
    TOO_SHORT,
    UNEQUAL_TASKS,
)
from neol.study.outcomes.campaign_runs import SECONDS_IN_AN_HOUR
from neol.study.outcomes.paper_numbers import PAPER_SEEDS
from neol.study.outcomes.score import PAPER_GENERATIONS

SEED_COUNTS = (PAPER_SEEDS, 100, 300, 1000)
"""Where seeds are what open claims lack, these budgets are looked at."""


class NextStep(NamedTuple):
    """What would decide some of the open claims."""

    takes: str
    claims: int
    core_hours: str


def steps(ledger: pd.DataFrame, configuration: Configuration) -> list[NextStep]:
    """What the open claims lack, and what it costs; a claim counts where it lacks the most."""
    budget = configuration.budget
    elsewhere, where = (
        (budget.name, "tasks that are not shown here")
        if chosen_tasks(budget)
        else ("paper", "cells that this budget does not have: the paper's budget")
    )
    other = load_configuration(elsewhere, reading=configuration.reading)
    more = [seeds for seeds in SEED_COUNTS if seeds > budget.seed_count]
    takes: dict[str | float, tuple[str, float | None]] = {
        "runs": ("the rest of this budget's runs", None),
        **{
            seeds: (
                f"{seeds} seeds instead of {budget.seed_count}",
                core_hours(configuration, seeds),
            )
            for seeds in more
        },
        math.inf: ("more seeds than that: little or no difference is seen here", None),
        "generations": (
            f"{PAPER_GENERATIONS} generations",
            core_hours(configuration, budget.seed_count, PAPER_GENERATIONS),
        ),
        "cells": (where, core_hours(other, other.budget.seed_count)),
    }
    counts = Counter(_lack(parts, more) for _, parts in open_parts(ledger))
    return [
        NextStep(text, counts[lack], "--" if hours is None else three_figures(hours))
        for lack, (text, hours) in takes.items()
        if counts[lack]
    ]


def core_hours(
    configuration: Configuration, seeds: int, generations: int | None = None
) -> float | None:
    """What a budget's grid costs by measurement, held-out episodes left out; None if unknown."""
    first = [
        run_specs(configuration, Block(home(configuration), cell, 0, 0))[0]
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
    if NO_SUCH_CELL in reasons:
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
    if needed > SEED_COUNTS[-1]:
        return f"more than {SEED_COUNTS[-1]} seeds"
    return f"about {float(f'{needed:.1e}'):.0f} seeds"
