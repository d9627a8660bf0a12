"""Cost of a run by measurement; the workflow requests time on a cluster by it.

Core-seconds are evaluations x (steps of an evaluation x time of a step + NEAT's time for an
evaluation), with values of docs/benchmarks.csv; docs/scaling.md describes each measurement.
"""

import csv
from collections.abc import Callable
from functools import cache

from neol.spec.configuration import ROOT, Configuration
from neol.spec.run_spec import RunSpec
from neol.study.campaign.grid import Block, cells, home, run_specs

NEAT_POPULATION = 300
"""Population size of the measurement of NEAT's time."""

Get = Callable[[str, str, str], float | None]
"""Median of a quantity by task and by networks or method; None if not measured."""


@cache
def _medians() -> dict[tuple[str, str, str], float]:
    path = ROOT / "docs" / "benchmarks.csv"
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return {(row["quantity"], row["task"], row["networks"]): float(row["median"]) for row in rows}


def shipped(quantity: str, task: str, networks: str = "") -> float | None:
    """Return a median of docs/benchmarks.csv."""
    return _medians().get((quantity, task, networks))


def like(method: str) -> str:
    """Return the method whose short runs were measured for it: NEAT, or Hebb for all others."""
    return "neat" if method == "neat" else "hebb"


def neat_seconds(get: Get, task: str) -> float:
    """Return NEAT's time per evaluation, for a population grown for 200 generations."""
    return (get("neat_generation", task, "") or 0.0) / 1e3 / NEAT_POPULATION


def evaluation_seconds(get: Get, task: str, method: str, steps: float) -> float:
    """Return the core-seconds of an evaluation with a number of steps."""
    return steps * (get("short_run", task, like(method)) or 0.0) / 1e6 + neat_seconds(get, task)


def run_seconds(spec: RunSpec, get: Get = shipped, *, to_the_limit: bool = False) -> float | None:
    """Return the core-seconds of one run without its held-out episodes; None if not measured.

    Episodes are as long as in the short runs, and in later generations as in their last third; or
    all of them last to the limit.
    """
    task, method, limit = spec.task.name, like(spec.method), spec.task.max_steps
    early, late = (get(f"short_run_{part}", task, method) for part in ("steps", "late_steps"))
    if early is None or late is None:
        return None
    measured = min((get("short_run_generations", task, "") or 0.0) / spec.generations, 1.0)
    usual = measured * early + (1.0 - measured) * late
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
