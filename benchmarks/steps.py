"""Environment steps: of every engine, of physics and network alone, of the same loop in C."""

import ctypes
from collections.abc import Callable
from functools import partial

from benchmarks import c_loop
from benchmarks.measure import (
    METHOD,
    POPULATION,
    RULES,
    Measurement,
    Scale,
    Values,
    cpu_seconds,
    run_spec_of,
)
from benchmarks.networks import initial_topology, large, recording_of
from benchmarks.trajectories import (
    Recording,
    seconds_of_gymnasium,
    seconds_of_physics,
    seconds_of_resets,
)
from neol.rollout import Engine, make_engine
from neol.rollout.environment import network_size
from neol.rollout.fast import FastEngine
from neol.rollout.reference import ReferenceEngine
from neol.rollout.worlds.box2d import library as box2d
from neol.rollout.worlds.box2d.environment import Simulation
from neol.spec.constants import Task


def both_recordings(task: str, scale: Scale, generations: int) -> dict[str, Recording]:
    """Record episodes of small and of large networks, which compiles all engines."""
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


def engine_measurements(recording: Recording) -> dict[str, Measurement]:
    """Prepare the measurement of microseconds per step of all that can play these episodes."""
    per_step = 1e6 / recording.steps
    reference = ReferenceEngine(recording.task)
    paths = engines_by_path(recording.task)
    played = (recording.networks, recording.seeds, recording.plasticity)

    def playback() -> Values:
        none = cpu_seconds(lambda: recording.play_back("none"))
        rule = cpu_seconds(lambda: recording.play_back(METHOD))
        return {"network": none * per_step, "plasticity": (rule - none) * per_step}

    def neighbours() -> Values:
        values = {"engine": cpu_seconds(lambda: recording.engine.evaluate(*played)) * per_step}
        if recording.task.name != "cartpole":
            values["physics"] = seconds_of_physics(recording) * per_step
        for path, engine in paths.items():
            values[f"engine_{path}"] = cpu_seconds(partial(engine.evaluate, *played)) * per_step
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


def engines_by_path(task: Task) -> dict[str, Engine]:
    """Return an engine for each available path of Box2D's physics; none for other tasks."""
    if task.environment not in box2d.TASKS:
        return {}
    core = box2d.load()
    assert isinstance(core, ctypes.CDLL)
    return {
        path: FastEngine(
            partial(Simulation, core, task.environment, path, box2d.SLOTS[path]), task.max_steps
        )
        for path in box2d.available_paths(core)
    }


def _mean_of(seconds: Callable[[Recording], float], recording: Recording) -> float:
    measured = [seconds(recording)]
    while sum(measured) < 0.01:
        measured.append(seconds(recording))
    return sum(measured) / len(measured)


def c_measurement(recording: Recording) -> Measurement:
    """Prepare the measurement of large networks by rule: our kernels and a loop in C."""
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
