"""A soak: a campaign for many minutes, and whether any process's memory or open files grow.

`python -m benchmarks.soak --minutes 45` clones this checkout to a temporary folder, runs a budget
of many blocks there with two workers each, looks at every process at regular times, and prints
for each kind of process how its figures depend on its age. With `--pid` it looks at a workflow
that is running already, and leaves it alone.
"""

import argparse
import contextlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import psutil

from neol.rollout.worlds.box2d.library import LIBRARY
from neol.spec.configuration import ROOT, load_configuration

BUDGET = """
budget:
  generations: 40
  seeds: 600
  populations: [10, 12, 14, 16, 18, 100]
  learning_rates: [2.5e-3]
  tasks: [cartpole, lunar_lander, hopper, bipedal_walker]
  methods: [bcm, neat]
  seeds_per_job: 20
tasks:
  hopper: {max_steps: 500}
  bipedal_walker: {max_steps: 500}
"""
WARM_UP = 300.0
"""Seconds: a younger process has not yet met its largest networks."""
MOST_GROWTH = {"memory": 24.0, "threads": np.inf, "files": 1.0}
"""A figure is flat where it grows by less in an hour, or by no more than chance explains.

Snakemake starts a thread for each of its first jobs, up to the number of cores and one.
"""
MIB = 2**20

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Sample:
    """One process at one time."""

    kind: str
    process: tuple[int, float]
    """Its number and when it began."""
    time: float
    """Of the look, in seconds of the epoch."""
    age: float
    """Seconds."""
    memory: float
    """Resident, MiB."""
    threads: int
    files: int
    """Open file descriptors."""


def main() -> None:
    """Run or watch the soak; exits with 1 where anything grows, or the workflow ended early."""
    parser = argparse.ArgumentParser(description=__doc__, prog="python -m benchmarks.soak")
    parser.add_argument("--minutes", type=float, default=45)
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--every", type=float, default=5, help="seconds between two looks")
    parser.add_argument("--pid", type=int, help="of a running workflow to watch instead")
    arguments = parser.parse_args()
    seconds, every = arguments.minutes * 60, arguments.every
    if arguments.pid is not None:
        samples = _watch(psutil.Process(arguments.pid), seconds, every)
    else:
        with tempfile.TemporaryDirectory(prefix="neol-soak-") as folder:
            samples = _campaign(_clone(Path(folder, "neol")), arguments.cores, seconds, every)
    minutes = (samples[-1].time - samples[0].time) / 60
    jobs = len({sample.process for sample in samples if sample.kind == "neol run"})
    print(f"{minutes:.0f} of {arguments.minutes:g} minutes, {jobs} jobs")
    flat = _report(samples)
    print("verdict: " + ("flat" if flat else "something grows"))
    sys.exit(not flat or minutes < 0.9 * arguments.minutes)


def _clone(folder: Path) -> Path:
    """This checkout's commit with the soak's budget, and the compiled core."""
    subprocess.run(["git", "clone", "--quiet", ROOT, folder], check=True)
    (folder / "config" / "soak.yaml").write_text(BUDGET)
    if LIBRARY.exists():
        shutil.copy2(LIBRARY, folder / LIBRARY.relative_to(ROOT))
    return folder


def _campaign(clone: Path, cores: int, seconds: float, every: float) -> list[Sample]:
    """Run it, look at it for so long, and end it."""
    environment = os.environ | {"PYTHONPATH": str(clone)}
    for task in load_configuration("paper").budget.tasks:  # compile before anything is looked at
        first = f"run --task {task} --method neat --population 4 --generations 2 --quiet --output"
        command = [sys.executable, "-m", "neol", *first.split(), f"{task}.parquet"]
        subprocess.run(command, cwd=clone, env=environment, check=True)
    command = (
        "-m snakemake records --config budget=soak --quiet all "
        f"--cores {cores} --set-threads run={cores}"
    )
    workflow = subprocess.Popen(
        [sys.executable, *command.split()], cwd=clone, env=environment, start_new_session=True
    )
    try:
        return _watch(psutil.Process(workflow.pid), seconds, every)
    finally:
        if workflow.poll() is None:
            os.killpg(workflow.pid, signal.SIGTERM)
            workflow.wait()


def _watch(workflow: psutil.Process, seconds: float, every: float) -> list[Sample]:
    """Look at a workflow and its jobs for so long, or until it ends."""
    samples: list[Sample] = []
    end = time.monotonic() + seconds
    with contextlib.suppress(psutil.NoSuchProcess):
        while time.monotonic() < end and workflow.status() != psutil.STATUS_ZOMBIE:
            samples.extend(_look(workflow))
            time.sleep(every)
    return samples


def _look(parent: psutil.Process) -> Iterator[Sample]:
    """A process and its descendants, now."""
    for process in (parent, *parent.children(recursive=True)):
        try:
            with process.oneshot():
                yield Sample(
                    kind=_kind(process.cmdline()),
                    process=(process.pid, process.create_time()),
                    time=time.time(),
                    age=time.time() - process.create_time(),
                    memory=process.memory_info().rss / MIB,
                    threads=process.num_threads(),
                    files=process.num_fds(),
                )
        except psutil.Error:  # it has ended
            continue


def _kind(command: list[str]) -> str:
    if "bash" in command[0]:
        return "shell"
    words = " ".join(command)
    return next((kind for kind in ("neol run", "snakemake") if kind in words), "other")


def _report(samples: list[Sample]) -> bool:
    """Print a line for each kind of process and figure; whether all are flat."""
    groups = defaultdict(list)
    for sample in samples:
        if sample.age > WARM_UP:
            groups[sample.kind].append(sample)
    line = "{:<10} {:<8} {:>7} {:>7} {:>8} {:>8} {:>8} {:>18}".format
    print(line("process", "figure", "samples", "oldest", "first", "last", "largest", "an hour"))
    flat = True
    for kind, group in sorted(groups.items()):
        group.sort(key=lambda sample: sample.age)
        tenth = max(1, len(group) // 10)
        for figure, most in MOST_GROWTH.items():
            values = np.array([getattr(sample, figure) for sample in group], dtype=float)
            slope, error = _slope(group, values)
            grows = slope > max(most, 2 * error)
            flat &= not grows
            ends = (values[:tenth].mean(), values[-tenth:].mean(), values.max())
            shown = [f"{value:.1f}" for value in ends] + [f"{slope:.2f} ± {error:.2f}"]
            oldest = f"{group[-1].age / 60:.0f} min"
            print(line(kind, figure, len(group), oldest, *shown), "GROWS" * grows)
    return flat


def _slope(group: list[Sample], values: Floats) -> tuple[float, float]:
    """Growth an hour and its standard error: one line for all processes, each with its own level.

    Samples of a process resemble each other, so the error is that over processes where there are
    several.
    """
    x, y = np.array([sample.age for sample in group]) / 3600, values.copy()
    names = [sample.process for sample in group]
    parts = [np.array([name == process for name in names]) for process in dict.fromkeys(names)]
    for part in parts:
        x[part] -= x[part].mean()
        y[part] -= y[part].mean()
    spread = float((x**2).sum())
    if spread == 0:
        return 0.0, 0.0
    slope = float((x * y).sum() / spread)
    rest = y - slope * x
    clusters = [float((x[part] * rest[part]).sum()) ** 2 for part in parts]
    if len(parts) > 1:
        return slope, float(np.sqrt(sum(clusters)) / spread)
    return slope, float(np.sqrt((rest**2).sum() / max(1, len(x) - 2) / spread))


if __name__ == "__main__":
    main()
