"""The contestants. Each measures once and returns its values by name; `run` interleaves them.

Times of one core are the process's CPU time, so that a neighbour on the machine counts as little
as possible; only two workers against one is wall time.
"""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any
from unittest.mock import patch

import numpy as np
import numpy.typing as npt

from benchmarks import c_loop
from benchmarks.networks import initial_topology, join, large, recording_of
from benchmarks.trajectories import (
    Recording,
    record,
    seconds_of_gymnasium,
    seconds_of_physics,
    seconds_of_resets,
)
from neol import evolution
from neol.constants import Plasticity
from neol.evolution import Evolution
from neol.neat.reproduction import Reproduction
from neol.network import Networks
from neol.rollout import Engine, Rollouts, make_engine
from neol.rollout.reference import ReferenceEngine, network_size
from neol.run import run_seed
from neol.spec import RunSpec, load_configuration

Values = dict[str, float]
Contestant = Callable[[], Values]

METHOD, RATE = "hebb", 2.5e-4  # the cheapest rule, for the peer too, at its rate of Table 3
RULES = ("hebb", "oja", "bcm")


@dataclass(frozen=True)
class Scale:
    """How much is measured, for one task."""

    steps: int
    """Environment steps of a recording."""
    run: int
    """Generations of the whole runs against the peer, P = 50."""
    worker_run: int
    """Generations of the runs with one and two workers, P = 100."""
    short_run: int
    """Generations of the runs that tell how long evaluations are, P = 50."""


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
POPULATION = 50


def run_spec_of(
    task: str, population: int, generations: int, *, method: str = METHOD, seed: int = 0
) -> RunSpec:
    """A run with the paper's constants; a single held-out episode, which is not measured work."""
    configuration = load_configuration("paper", ["evaluation.held_out_episodes=1"])
    return configuration.run_spec(
        task=task,
        method=method,
        population=population,
        learning_rate=RATE if method == METHOD else None,
        generations=generations,
        seed=seed,
    )


def cpu_seconds(work: Callable[[], object], at_least: float = 0.05) -> float:
    """CPU seconds of one call, from as many as it takes to fill the time."""
    calls, seconds = 0, 0.0
    while seconds < at_least:
        start = time.process_time()
        work()
        seconds += time.process_time() - start
        calls += 1
    return seconds / calls


def engine_contestants(recording: Recording) -> dict[str, Contestant]:
    """Microseconds per environment step of everything that can play these episodes."""
    per_step = 1e6 / recording.steps
    reference = ReferenceEngine(recording.task)
    played = (recording.networks, recording.seeds, recording.plasticity)

    def playback() -> Values:
        none = cpu_seconds(lambda: recording.play_back("none"))
        rule = cpu_seconds(lambda: recording.play_back(METHOD))
        return {"network": none * per_step, "plasticity": (rule - none) * per_step}

    def neighbours() -> Values:
        values = {"engine": cpu_seconds(lambda: recording.engine.evaluate(*played)) * per_step}
        if recording.task.name != "cartpole":
            values["physics"] = seconds_of_physics(recording) * per_step
        return values

    return {
        "engine, physics": neighbours,
        "resets": lambda: {"resets": _mean_of(seconds_of_resets, recording) * per_step},
        "playback": playback,
        "gymnasium": lambda: {"gymnasium": seconds_of_gymnasium(recording) * per_step},
        "reference": lambda: {
            "reference": cpu_seconds(lambda: reference.evaluate(*played)) * per_step
        },
    }


def _mean_of(seconds: Callable[[Recording], float], recording: Recording) -> float:
    measured = [seconds(recording)]
    while sum(measured) < 0.01:
        measured.append(seconds(recording))
    return sum(measured) / len(measured)


def c_contestant(recording: Recording) -> Contestant:
    """Network and plasticity of large networks, by rule: our kernels, and the same loop in C."""
    per_step = 1e6 / recording.steps

    def both() -> Values:
        values = {}
        for rule in RULES:
            ours = cpu_seconds(partial(recording.play_back, rule))
            theirs = cpu_seconds(partial(c_loop.play_back, recording, rule))
            values[f"kernels_{rule}"] = ours * per_step
            values[f"c_{rule}"] = theirs * per_step
        return values

    return both


@dataclass
class MeasuringEngine:
    """Passes batches on to an engine; knows how long they took and, if asked to, keeps them."""

    engine: Engine
    keep: bool = False
    seconds: float = 0.0
    steps: int = 0
    evaluations: int = 0
    kept: list[tuple[Networks, npt.NDArray[np.uint64]]] = field(default_factory=list)
    name: str = "measuring"

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        start = time.process_time()
        rollouts = self.engine.evaluate(networks, seeds, plasticity)
        self.seconds += time.process_time() - start
        self.steps += int(rollouts.steps.sum())
        self.evaluations += len(seeds)
        if self.keep:
            self.kept.append((networks, seeds))
        return rollouts

    def close(self) -> None:
        self.engine.close()


NEAT_PARTS = {
    "decode": (evolution, "decode"),
    "encode": (evolution, "encode_weights"),
    "speciate": (evolution, "speciate"),
    "seeds": (evolution, "episode_seeds"),
    "reproduce": (Reproduction, "reproduce"),
    "initial": (Reproduction, "initial_population"),
}
"""The calls that NEAT consists of in a step of an evolution."""


@contextmanager
def timed_parts() -> Iterator[Values]:
    """CPU seconds that each part of NEAT takes while the context lasts."""
    seconds = dict.fromkeys(NEAT_PARTS, 0.0)

    def timed(part: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            start = time.process_time()
            try:
                return function(*arguments)
            finally:
                seconds[part] += time.process_time() - start

        return call

    with ExitStack() as stack:
        for part, (owner, name) in NEAT_PARTS.items():
            stack.enter_context(patch.object(owner, name, timed(part, getattr(owner, name))))
        yield seconds


def whole_run_contestants(spec: RunSpec, engine: Engine) -> dict[str, Contestant]:
    """A whole run of ours and of the peer, and what the episodes of ours consist of.

    `run_seed` is all that `neol run` does but for writing the record. Its time splits into the
    calls of the engine, the calls of NEAT and the rest (statistics, digest, snapshots). To split
    the engine's part, the episodes of that very run are recorded beforehand: they are played back
    without a world (network, plasticity), and the physics is stepped without a network.
    """
    from benchmarks import peer as neat_python

    capture = MeasuringEngine(engine, keep=True)
    run_seed(spec, capture)
    capture.kept.pop()  # the held-out episode
    networks = join([networks for networks, _ in capture.kept])
    seeds = np.concatenate([seeds for _, seeds in capture.kept])
    recording = record(spec.task, engine, networks, seeds, spec.plasticity)

    def ours() -> Values:
        measuring = MeasuringEngine(engine)
        with timed_parts() as parts:
            start = time.process_time()
            run_seed(spec, measuring)
            seconds = time.process_time() - start
        per_step = 1e6 / measuring.steps
        neat = sum(parts.values())
        return {
            "run": seconds * per_step,
            "run_engine": measuring.seconds * per_step,
            "run_neat": neat * per_step,
            "run_other": (seconds - measuring.seconds - neat) * per_step,
            "run_steps_per_evaluation": measuring.steps / measuring.evaluations,
        }

    def peer() -> Values:
        result = neat_python.run_spec(spec)
        return {
            "peer": result.seconds / result.steps * 1e6,
            "peer_steps_per_evaluation": result.steps / (spec.population * spec.generations),
        }

    def episodes() -> Values:
        per_step = 1e6 / recording.steps
        none = cpu_seconds(lambda: recording.play_back("none"))
        rule = cpu_seconds(lambda: recording.play_back(METHOD))
        values = {"run_network": none * per_step, "run_plasticity": (rule - none) * per_step}
        if spec.task.name != "cartpole":
            values["run_physics"] = seconds_of_physics(recording) * per_step
        return values

    return {"ours": ours, "episodes": episodes, "peer": peer}


def worker_contestant(spec: RunSpec) -> Contestant:
    """Wall seconds of a run's generations with one worker and with two, one after the other.

    And what share of the one worker's CPU time lies outside the engine: that stays one worker's.
    """
    size = network_size(spec.task)
    one, two = make_engine(spec.task, "fast", 1), make_engine(spec.task, "fast", 2)

    def generations(engine: Engine) -> None:
        for _ in Evolution.begin(spec, *size).run(engine):
            pass

    def both() -> Values:
        measuring = MeasuringEngine(one)
        start, cpu_start = time.perf_counter(), time.process_time()
        generations(measuring)
        seconds, cpu = time.perf_counter() - start, time.process_time() - cpu_start
        start = time.perf_counter()
        generations(two)
        return {
            "one_worker": seconds,
            "two_workers": time.perf_counter() - start,
            "serial_share": 1.0 - measuring.seconds / cpu,
        }

    both()  # every thread has its simulation
    return both


class NoEnvironment:
    """An engine in which nothing happens: random fitness, weights as they were."""

    name = "none"

    def __init__(self) -> None:
        self._random = np.random.default_rng(0)

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        del plasticity
        return Rollouts(
            returns=self._random.normal(size=seeds.shape),
            steps=np.ones(seeds.shape, dtype=np.int64),
            weight=networks.weight.copy(),
            threshold=np.zeros_like(networks.bias),
            failed=np.zeros(len(seeds), dtype=np.bool_),
        )

    def close(self) -> None:
        pass


def neat_after(
    task: str, population: int, generations: int, timed: int = 10
) -> tuple[Values, Contestant]:
    """NEAT's milliseconds a generation once a population has grown for so many generations.

    The growth is synthetic: real NEAT with the task's inputs and outputs, but random fitness.
    Returns what has grown, and the contestant, which goes on by some generations at each call.
    All that a step does outside the engine counts, statistics and digest too.
    """
    spec = run_spec_of(task, population, 10**6, method="neat")
    measuring = MeasuringEngine(NoEnvironment())
    grown = Evolution.begin(spec, *network_size(spec.task))
    for _ in range(generations):
        last = grown.step(measuring)
    sizes = {
        "grown_nodes": last.nodes_mean,
        "grown_connections": last.connections_mean,
        "grown_species": float(last.species),
    }

    def step() -> Values:
        before = measuring.seconds
        with timed_parts() as parts:
            start = time.process_time()
            for _ in range(timed):
                grown.step(measuring)
            seconds = time.process_time() - start - (measuring.seconds - before)
        values = {f"neat_{part}": parts[part] / timed * 1e3 for part in parts if part != "initial"}
        return {**values, "neat_generation": seconds / timed * 1e3}

    return sizes, step


def short_run(task: str, method: str, generations: int) -> Values:
    """A real run: steps per evaluation over all and over its last third, CPU time per step."""
    spec = run_spec_of(task, POPULATION, generations, method=method)
    with closing(make_engine(spec.task, "fast")) as engine:
        start = time.process_time()
        history = run_seed(spec, engine).history
        seconds = time.process_time() - start
    steps = np.diff([0, *(generation.env_steps for generation in history)]) / POPULATION
    return {
        "short_run": seconds / history[-1].env_steps * 1e6,
        "short_run_steps": float(steps.mean()),
        "short_run_late_steps": float(steps[-max(1, generations // 3) :].mean()),
    }


def peak_memory(task: str, population: int, generations: int) -> Values:
    """Peak resident memory of a run in a process of its own, in megabytes, kernels compiled."""

    def megabytes(generations: int) -> float:
        command = [sys.executable, "-W", "ignore", "-m", "benchmarks.memory"]
        command += [task, str(population), str(generations)]
        result = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
        return float(result.stdout)

    megabytes(2)  # compiles
    return {"peak_memory": megabytes(generations)}


def both_recordings(task: str, scale: Scale, generations: int) -> dict[str, Recording]:
    """Episodes of small and of large networks; all that plays them is compiled afterwards."""
    spec = run_spec_of(task, POPULATION, 1)
    engine = make_engine(spec.task, "fast")
    size = network_size(spec.task)
    small = initial_topology(spec, engine, size, generations)
    recordings = {
        "initial": recording_of(spec, engine, small, scale.steps),
        "large": recording_of(spec, engine, large(spec, size, 30), scale.steps),
    }
    recordings["large"].play_back(METHOD)
    seconds_of_resets(recordings["large"])
    if task != "cartpole":
        seconds_of_physics(recordings["large"])
    return recordings
