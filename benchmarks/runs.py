"""Whole runs: beside the peer, with two workers, NEAT in evolved populations, and memory."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field
from typing import Any
from unittest.mock import patch

import numpy as np
import numpy.typing as npt

from benchmarks.measure import METHOD, POPULATION, Measurement, Values, cpu_seconds, run_spec_of
from benchmarks.networks import join
from benchmarks.trajectories import record
from neol.neat.reproduction import Reproduction
from neol.network.forward import Networks
from neol.rollout import Engine, Rollouts, make_engine
from neol.rollout.environment import network_size
from neol.run import evolution
from neol.run.evolution import Evolution
from neol.run.single import run_seed
from neol.spec.constants import Plasticity
from neol.spec.run_spec import RunSpec


@dataclass
class MeasuringEngine:
    """Engine that passes batches on to another, measures their time and optionally keeps them."""

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
"""Calls of NEAT in a step of an evolution."""


@contextmanager
def timed_parts() -> Iterator[Values]:
    """Measure the CPU seconds of each part of NEAT during the context."""
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


def whole_run_measurements(spec: RunSpec, engine: Engine) -> dict[str, Measurement]:
    """Prepare the measurement of a whole run of ours and the peer, and parts of our episodes.

    `run_seed` is all that `neol run` does but for writing the record. Its time splits into the
    calls of the engine, the calls of NEAT and the rest (statistics, digest). To split
    the engine's part, the episodes of that very run are recorded beforehand and played back without
    a world (network, plasticity).
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
        return {"run_network": none * per_step, "run_plasticity": (rule - none) * per_step}

    return {"ours": ours, "episodes": episodes, "peer": peer}


def worker_measurement(spec: RunSpec) -> Measurement:
    """Prepare the measurement of a run's wall seconds with one worker and with two, in turn.

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
    """Engine without episodes: random fitness, unchanged weights."""

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
) -> tuple[Values, Measurement]:
    """Measure NEAT's milliseconds per generation in a population evolved for some generations.

    The growth is synthetic: real NEAT with the task's inputs and outputs, but random fitness.
    Returns what has grown, and the measurement, which goes on by some generations at each call.
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
    """Measure a real run: CPU time per step, and steps per evaluation in its last third."""
    spec = run_spec_of(task, POPULATION, generations, method=method)
    with closing(make_engine(spec.task, "fast")) as engine:
        start = time.process_time()
        history = run_seed(spec, engine).history
        seconds = time.process_time() - start
    steps = np.diff([0, *(generation.env_steps for generation in history)]) / POPULATION
    return {
        "short_run": seconds / history[-1].env_steps * 1e6,
        "short_run_late_steps": float(steps[-max(1, generations // 3) :].mean()),
    }


def peak_memory(task: str, population: int, generations: int) -> Values:
    """Return the peak memory in megabytes of a run in its own process, with compiled kernels."""

    def megabytes(generations: int) -> float:
        command = [sys.executable, "-W", "ignore", "-m", "benchmarks.memory"]
        command += [task, str(population), str(generations)]
        result = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
        return float(result.stdout)

    megabytes(2)  # compiles
    return {"peak_memory": megabytes(generations)}
