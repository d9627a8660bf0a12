"""Size of the measurements, the measured runs, and the measurement of CPU time.

Times of one core are the process's CPU time, so that a neighbour on the machine counts as little
as possible; only two workers against one is wall time.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec

Values = dict[str, float]
Measurement = Callable[[], Values]
"""Function that measures once and returns values by name; `run` interleaves several."""

METHOD, RATE = "hebb", 2.5e-4  # the cheapest rule, for the peer too, at its rate of Table 3
RULES = ("hebb", "oja", "bcm")
POPULATION = 50
AT_LEAST = 0.05
"""CPU seconds over which a short call is repeated."""


@dataclass(frozen=True)
class Scale:
    """Size of the measurements of one task."""

    steps: int
    """Environment steps of a recording."""
    run: int
    """Generations of the whole runs against the peer, P = 50."""
    worker_run: int
    """Generations of the runs with one and two workers, P = 100."""
    short_run: int
    """Generations of the runs that measure CPU time per step, P = 50."""


FULL = {
    "cartpole": Scale(steps=20_000, run=30, worker_run=60, short_run=100),
    "lunar_lander": Scale(steps=8_000, run=10, worker_run=20, short_run=100),
    "hopper": Scale(steps=4_000, run=3, worker_run=5, short_run=12),
    "bipedal_walker": Scale(steps=4_000, run=2, worker_run=2, short_run=20),
}
QUICK = {
    "cartpole": Scale(steps=10_000, run=10, worker_run=5, short_run=10),
    "lunar_lander": Scale(steps=4_000, run=3, worker_run=2, short_run=10),
    "hopper": Scale(steps=2_000, run=2, worker_run=1, short_run=3),
    "bipedal_walker": Scale(steps=2_000, run=1, worker_run=1, short_run=3),
}


def run_spec_of(
    task: str, population: int, generations: int, *, method: str = METHOD, seed: int = 0
) -> RunSpec:
    """Return a run with the paper's constants and one held-out episode, which is not measured."""
    configuration = load_configuration("paper", ["evaluation.held_out_episodes=1"])
    return configuration.run_spec(
        task=task,
        method=method,
        population=population,
        learning_rate=RATE if method == METHOD else None,
        generations=generations,
        seed=seed,
    )


def cpu_seconds(work: Callable[[], object]) -> float:
    """Return the CPU seconds of one call, from as many calls as fit into `AT_LEAST`."""
    calls, seconds = 0, 0.0
    while seconds < AT_LEAST:
        start = time.process_time()
        work()
        seconds += time.process_time() - start
        calls += 1
    return seconds / calls
