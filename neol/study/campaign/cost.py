"""Cost of a run by measurement; the workflow requests time on a cluster by it.

Core-seconds are evaluations x (steps of an evaluation x time of a step + NEAT's time for an
evaluation). Times are those of docs/benchmarks.csv, steps those of docs/episode-lengths.csv;
docs/scaling.md describes each measurement.
"""

import csv
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from statistics import fmean

import numpy as np

from neol.spec.configuration import ROOT, Configuration
from neol.spec.run_spec import RunSpec
from neol.study.campaign.grid import Block, cells, home, run_specs

EPISODE_LENGTHS = ROOT / "docs" / "episode-lengths.csv"
NEAT_POPULATION = 300
"""Population size of the measurement of NEAT's time."""

Get = Callable[[str, str, str], float | None]
"""Median of a quantity by task and by networks or method; None if not measured."""
Lengths = dict[int, float]
"""Mean steps of an evaluation in all generations until some of them."""


def _rows(path: Path) -> Iterator[dict[str, str]]:
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return iter(csv.DictReader(line for line in lines if not line.startswith("#")))


@cache
def _medians() -> dict[tuple[str, str, str], float]:
    rows = _rows(ROOT / "docs" / "benchmarks.csv")
    return {(row["quantity"], row["task"], row["networks"]): float(row["median"]) for row in rows}


@cache
def recorded_lengths() -> dict[str, dict[str, Lengths]]:
    """Return the steps of evaluations in the records of `evidence`, by task and method."""
    lengths: dict[str, dict[str, Lengths]] = {}
    for row in _rows(EPISODE_LENGTHS):
        of_task = lengths.setdefault(row["task"], {})
        of_task.setdefault(row["method"], {})[int(row["generation"])] = float(row["steps"])
    return lengths


def shipped(quantity: str, task: str, networks: str = "") -> float | None:
    """Return a median of docs/benchmarks.csv."""
    return _medians().get((quantity, task, networks))


def like(method: str) -> str:
    """Return the method whose time of a step was measured for it: NEAT, or Hebb for all others."""
    return "neat" if method == "neat" else "hebb"


def neat_seconds(get: Get, task: str) -> float:
    """Return NEAT's time per evaluation, for a population grown for 200 generations."""
    return (get("neat_generation", task, "") or 0.0) / 1e3 / NEAT_POPULATION


def evaluation_seconds(get: Get, task: str, method: str, steps: float) -> float:
    """Return the core-seconds of an evaluation with a number of steps."""
    return steps * (get("short_run", task, like(method)) or 0.0) / 1e6 + neat_seconds(get, task)


def steps_of_an_evaluation(task: str, method: str, generations: int) -> float | None:
    """Return the mean over a run; None if the task has no records.

    Later generations are taken to be like the last recorded ones, and a method without records like
    the average method.
    """
    of_task = recorded_lengths().get(task, {})
    if method not in of_task:
        each = [steps_of_an_evaluation(task, other, generations) for other in of_task]
        return fmean(filter(None, each)) if each else None
    recorded = np.array(list(of_task[method]))
    steps = recorded * np.array(list(of_task[method].values()))
    latest = (steps[-1] - steps[-2]) / (recorded[-1] - recorded[-2])
    beyond = max(generations - int(recorded[-1]), 0) * latest
    return float(np.interp(generations, recorded, steps) + beyond) / generations


def run_seconds(spec: RunSpec, get: Get = shipped, *, to_the_limit: bool = False) -> float | None:
    """Return the core-seconds of one run without its held-out episodes; None if not measured.

    Episodes are as long as in the records, or all of them last to the limit.
    """
    task, limit = spec.task.name, spec.task.max_steps
    usual = steps_of_an_evaluation(task, spec.method, spec.generations)
    if usual is None or get("short_run", task, like(spec.method)) is None:
        return None
    steps = limit if to_the_limit else min(usual, limit)
    evaluations = spec.generations * spec.population * spec.evaluation.episodes
    return evaluations * evaluation_seconds(get, task, spec.method, steps)


def walltime_minutes(spec: RunSpec, seeds: int) -> int:
    """Return the walltime to request: twice the time of the runs, plus a quarter of an hour.

    Cores may be slower and episodes longer than those measured. If it is too short nothing is
    lost, because a run continues from its checkpoint. A day for a task that was never measured.
    """
    seconds = run_seconds(spec)
    return 24 * 60 if seconds is None else 15 + round(2 * seeds * seconds / 60)


def core_hours(configuration: Configuration) -> float | None:
    """Return the measured cost of a budget's grid without held-out episodes; None if unknown."""
    total = 0.0
    for cell in cells(configuration):
        (first,) = run_specs(configuration, Block(home(configuration), cell, 0, 0))
        if (seconds := run_seconds(first)) is None:
            return None
        total += len(configuration.budget.seeds_of(cell.task)) * seconds
    return total / 3600
