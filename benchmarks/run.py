"""Measure everything in one interleaved run and write it to docs/: `make bench`.

A round makes every measurement once, one after the other, and begins with another one each time;
ratios are taken within a round, and what is written is the median over the rounds.
"""

import argparse
import logging
import sys
import time
import warnings
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from benchmarks import envpool_steps, report, runs, steps
from benchmarks.measure import FULL, POPULATION, QUICK, Measurement, Scale, run_spec_of
from benchmarks.table import Key, summarise
from neol.base.errors import UserError, hint
from neol.rollout import make_engine


def main(command_line: Sequence[str] | None = None) -> None:
    """Measure and write. Arguments are by default those of the command line.

    Raises UserError for wrong ones, and where something is missing that the measurements need.
    """
    arguments = _arguments(command_line)
    logging.disable(logging.WARNING)
    warnings.filterwarnings("ignore")
    begin = time.perf_counter()
    import benchmarks.peer  # noqa: F401  # says at once what it needs

    values = run(arguments.tasks, arguments.rounds, arguments.quick)
    minutes = (time.perf_counter() - begin) / 60
    table = summarise(values)
    note = f"{'quick run, not for comparison; ' * arguments.quick}took {minutes:.1f} minutes"
    report.write(arguments.output, table, report.machine() | {"Run": note})
    _say(f"wrote {arguments.output}/benchmarks.csv, .md, .png ({note})")


def run(tasks: list[str], rounds: int, quick: bool) -> dict[Key, list[float]]:
    """Measure everything; return for each key one value for each round."""
    values: dict[Key, list[float]] = defaultdict(list)
    scales = QUICK if quick else FULL
    measurements: list[tuple[str, str, Measurement]] = []
    for task in tasks:
        _say(f"{task}: prepare")
        for networks, measurement in _prepare(task, scales[task], quick, values):
            measurements.append((task, networks, measurement))
    for number in range(rounds):
        _say(f"round {number + 1} of {rounds}")
        turn = number * len(measurements) // rounds
        for task, networks, measure in measurements[turn:] + measurements[:turn]:
            for quantity, value in measure().items():
                values[quantity, task, networks].append(value)
    for task in tasks:
        _say(f"{task}: short runs")
        generations = scales[task].short_run
        for method in ("hebb", "neat"):
            short = runs.short_run(task, method, generations)
            for quantity, value in short.items():
                values[quantity, task, method].append(value)
    if "bipedal_walker" in tasks:
        _say("peak memory")
        memory = runs.peak_memory("bipedal_walker", 300, 20 if quick else 500)
        values["peak_memory", "bipedal_walker", ""].append(memory["peak_memory"])
    return values


def _prepare(
    task: str, scale: Scale, quick: bool, values: dict[Key, list[float]]
) -> list[tuple[str, Measurement]]:
    """Return a task's measurements after all kernels are compiled and libraries loaded."""
    measurements: list[tuple[str, Measurement]] = []
    recordings = steps.both_recordings(task, scale, generations=3 if quick else 8)
    for networks, recording in recordings.items():
        values["recorded_steps_per_episode", task, networks].append(
            recording.steps / len(recording.seeds)
        )
        measurements += [(networks, each) for each in steps.engine_measurements(recording).values()]
    measurements.append(("large", steps.c_measurement(recordings["large"])))
    if envpool_steps.AVAILABLE:
        measurements.append(("initial", envpool_steps.envpool_measurement(recordings["initial"])))

    spec = run_spec_of(task, POPULATION, scale.run)
    engine = make_engine(spec.task, "fast")
    values["run_generations", task, ""].append(float(scale.run))
    measurements += [("", each) for each in runs.whole_run_measurements(spec, engine).values()]

    spec = run_spec_of(task, 100, scale.worker_run)
    measurements.append(("", runs.worker_measurement(spec)))

    sizes, grown = runs.neat_after(task, 300, 30 if quick else 200, timed=3 if quick else 10)
    for quantity, value in sizes.items():
        values[quantity, task, ""].append(value)
    measurements.append(("", grown))
    return measurements


def _tasks(text: str) -> list[str]:
    tasks = text.split(",")
    for task in tasks:
        if task not in FULL:
            raise argparse.ArgumentTypeError(f'unknown task "{task}"{hint(task, FULL)}')
    return tasks


def _arguments(command_line: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.run", description=__doc__)
    parser.add_argument(
        "--tasks", type=_tasks, default=list(FULL), help="some only, like cartpole,hopper"
    )
    parser.add_argument("--rounds", type=int, default=None, help="5, or 2 with --quick")
    parser.add_argument("--quick", action="store_true", help="a small run, to see that all works")
    parser.add_argument("--output", type=Path, default=report.DOCS, help="a folder; docs/ if none")
    arguments = parser.parse_args(command_line)
    arguments.rounds = arguments.rounds or (2 if arguments.quick else 5)
    return arguments


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    try:
        main()
    except UserError as error:
        sys.exit(f"benchmarks: {error}")
