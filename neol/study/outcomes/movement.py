"""Measures of how far plasticity moves weights in the runs of a cell, from its records.

A weight's path over a run is the sum of its mean changes, one evaluation in each generation. With
write-back a child begins where its parent ended, so this is how far a line of descent can get.
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from neol.study.campaign.grid import Cell, cells
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.statistics import ALPHA, mean_interval

NEAR_CONTROL = 0.1
"""Below this path over a run, in standard deviations of initial weights, nothing is learned.

Were all changes of a weight in one direction, it would still end a tenth of a standard deviation
from where it began, a fifth of what a single mutation of NEAT's moves it by. Such a
cell is therefore a control: in effect NEAT without weight mutation.
"""
NEAR_CONTROL_WORDS = (
    "near control: over a whole run the changes of a weight add up to less than "
    f"{NEAR_CONTROL:g} standard deviations of the initial weights, too little to explain a "
    "difference by learning"
)
NEAR_CONTROL_MARK = "†"
"""Mark behind the name or value of such a cell."""
NEAR_CONTROL_NOTE = f"{NEAR_CONTROL_MARK} {NEAR_CONTROL_WORDS}."
"""Explanation of the mark, for what shows it."""


@dataclass(frozen=True, slots=True)
class Movement:
    """How far weights move, as means over the runs of a cell; NaN without runs."""

    per_evaluation: float
    """Mean |change| of a weight in an evaluation, over the population and the generations."""
    over_run: float
    """Length of a weight's path over the run, in standard deviations of initial weights."""


def movement(campaign: Campaign, cell: Cell) -> Movement:
    """Return how far weights move in the runs of a cell."""
    configuration = campaign.configuration
    by_run = campaign.runs(cell).rows.groupby("seed")["weight_change_mean"]
    per_evaluation = float(by_run.mean().mean())
    # Without write-back an evaluation's changes are lost at its end.
    path = float(by_run.sum().mean()) if configuration.plasticity.write_back else per_evaluation
    initial_sd = configuration.neat.weight_init_sd
    return Movement(per_evaluation, path / initial_sd if initial_sd else math.nan)


def is_near_control(campaign: Campaign, cell: Cell) -> bool:
    """Return whether a cell has a rule and runs in which the rule hardly moves a weight."""
    learns = campaign.configuration.methods[cell.method].learns
    return learns and movement(campaign, cell).over_run < NEAR_CONTROL


def movements(campaign: Campaign) -> pd.DataFrame:
    """Return a row for each cell with a rule: how far weights move, and if it is near control."""
    rows = []
    for cell in cells(campaign.configuration):
        if not campaign.configuration.methods[cell.method].learns:
            continue
        moved, seeds = movement(campaign, cell), len(campaign.runs(cell).held_out)
        place = cell.task, cell.method, cell.population, cell.learning_rate
        moves = moved.per_evaluation, moved.over_run, is_near_control(campaign, cell)
        rows.append((*place, seeds, *moves))
    columns = ["task", "method", "population", "learning_rate", "seeds"]
    columns += ["movement_per_evaluation", "movement_over_run", "near_control"]
    return pd.DataFrame(rows, columns=columns)


def read_switched_off(path: str) -> pd.DataFrame:
    """Read the returns of champions with and without plasticity; empty if the file is missing."""
    if Path(path).exists():
        return pd.read_csv(path)
    print(f"neol: {path}: missing, so no champion is shown without plasticity", file=sys.stderr)
    keys = ["task", "method", "population", "learning_rate", "seed"]
    return pd.DataFrame(columns=[*keys, "plastic", "fixed"])


def learning(campaign: Campaign, switched_off: pd.DataFrame) -> pd.DataFrame:
    """Return `movements`, and how switching plasticity off changes the champions' return.

    `switched_off` has a row for each champion that was played again: the cell's columns, seed, and
    its mean returns with plasticity, `plastic`, and without, `fixed`, in the same episodes. Their
    difference is averaged over `champions` in `switching_off`, with Student's interval `low` to
    `high`; NaN where none was played.
    """
    keys = ["task", "method", "population", "learning_rate"]
    gaps = switched_off.assign(gap=switched_off["fixed"] - switched_off["plastic"])
    rows = []
    for place, some in gaps.dropna(subset="gap").groupby(keys):
        values = some["gap"].to_numpy(dtype=np.float64)
        low, high = mean_interval(values)
        rows.append((*place, len(values), values.mean(), float(low), float(high)))
    columns = [*keys, "champions", "switching_off", "low", "high"]
    return movements(campaign).merge(pd.DataFrame(rows, columns=columns), how="left", on=keys)


def describe_learning(table: pd.DataFrame) -> list[str]:
    """Say in two sentences in how many cells switching plasticity off changes champions' return."""
    sentences = []
    for near, words in ((True, "near control"), (False, "where weights move")):
        played = table[(table["near_control"] == near) & table["low"].notna()]
        changed = int(((played["low"] > 0) | (played["high"] < 0)).sum())
        lower = int((played["high"] < 0).sum())
        sentences.append(
            f"Of {len(played)} cells {words}, switching plasticity off changes the champions' "
            f"return in {changed} (lower in {lower}); chance alone would give about "
            f"{ALPHA * len(played):.1f}."
        )
    return sentences
