"""What a return means: the level that champions reach on a task, in words.

A number such as 1,012 on Hopper says little without the task's rewards. Gymnasium's own reward
threshold, at which it calls a task solved, stands beside every level.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import pandas as pd

from neol.pictures.labels import task_label, value_range
from neol.study.outcomes.effects import thresholds


class Level(NamedTuple):
    """What agents do whose mean return is at least this much, up to the next level."""

    at_least: float
    words: str


LEVELS: Mapping[str, Sequence[Level]] = {
    "cartpole": (
        Level(0, "the pole falls early"),
        Level(195, "the pole often falls"),
        Level(475, "the pole stays up"),
    ),
    "lunar_lander": (
        Level(-1e9, "the lander crashes"),
        Level(0, "some landings succeed"),
        Level(200, "the lander lands"),
    ),
    "hopper": (
        Level(-1e9, "the hopper falls"),
        Level(900, "the hopper stands still, which pays 1 for each of 1,000 steps"),
        Level(1200, "the hopper hops"),
        Level(3800, "the hopper hops fast"),
    ),
    "bipedal_walker": (
        Level(-1e9, "the walker falls"),
        Level(-50, "the walker stands or kneels"),
        Level(20, "the walker walks part of the way"),
        Level(250, "the walker walks to the end"),
    ),
}
"""Levels of the paper's tasks, from the lowest. They follow from the tasks' rewards: a crash of the
lander and a fall of the walker pay -100, a landing +100, and the walker's whole way about 300.
"""


def describe_level(task: str, returns: float) -> str:
    """Say what agents with this mean return do; empty for a task without levels."""
    reached = [level.words for level in LEVELS.get(task, ()) if returns >= level.at_least]
    return reached[-1] if reached else ""


def levels_reached(selection: pd.DataFrame) -> list[str]:
    """Say for each task what champions return in fresh episodes, and what they do there.

    `selection` is the table `selection_bias`: a row for each task, method and population.
    """
    sentences = []
    for task, rows in selection.dropna(subset="held_out").groupby("task", sort=False):
        fresh = rows["held_out"]
        lowest, highest = (describe_level(str(task), each) for each in (fresh.min(), fresh.max()))
        meaning = lowest if lowest == highest else f"between “{lowest}” and “{highest}”"
        solved = thresholds().get(str(task))
        threshold = "" if solved is None else f" Gymnasium calls a mean of {solved:,g} solved."
        sentences.append(
            f"{task_label(str(task))}: champions return {value_range(fresh)} in fresh episodes"
            f"{f' ({meaning})' if meaning else ''}; their final best fitness was "
            f"{value_range(rows['final_best'])}.{threshold}"
        )
    return sentences
