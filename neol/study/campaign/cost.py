"""What a run costs by measurement; the workflow asks a cluster for as much time.

Core-seconds are evaluations x (steps of an evaluation x time of a step + NEAT's time for an
evaluation), as in docs/benchmarks.csv; docs/scaling.md says how each was measured.
"""

import csv
from collections.abc import Callable
from functools import cache

from neol.spec.configuration import ROOT
from neol.spec.run_spec import RunSpec

NEAT_POPULATION = 300
"""NEAT's time is measured with a population of this size."""

Get = Callable[[str, str, str], float | None]
"""The median of a quantity, by task and by networks or method; None where there is none."""


@cache
def _medians() -> dict[tuple[str, str, str], float]:
    path = ROOT / "docs" / "benchmarks.csv"
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return {(row["quantity"], row["task"], row["networks"]): float(row["median"]) for row in rows}


def shipped(quantity: str, task: str, networks: str = "") -> float | None:
    """As docs/benchmarks.csv has it."""
    return _medians().get((quantity, task, networks))


def like(method: str) -> str:
    """The method whose short runs stand for a method's: Hebb's for all that mutate no weights."""
    return "neat" if method == "neat" else "hebb"


def neat_seconds(get: Get, task: str) -> float:
    """NEAT's part of an evaluation, of a population grown for 200 generations."""
    return (get("neat_generation", task, "") or 0.0) / 1e3 / NEAT_POPULATION


def evaluation_seconds(get: Get, task: str, method: str, steps: float) -> float:
    """Core-seconds of an evaluation of so many steps."""
    return steps * (get("short_run", task, like(method)) or 0.0) / 1e6 + neat_seconds(get, task)


def run_seconds(spec: RunSpec, get: Get = shipped, *, to_the_limit: bool = False) -> float | None:
    """Core-seconds of one run, its held-out episodes left out; None for a task never measured.

    Episodes are as long as in the short runs, and after the generations of these as in their last
    third; or all as long as they may be.
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
    """What to ask a cluster for: twice the time of so many runs, and a quarter of an hour.

    A core may be slower and episodes longer than the measured ones. Nothing is lost where that was
    too little: a run goes on from its checkpoint. A day for a task that was never measured.
    """
    seconds = run_seconds(spec)
    return 24 * 60 if seconds is None else 15 + round(2 * seeds * seconds / 60)
