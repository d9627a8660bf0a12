"""Tiny runs on the reference engine, and functions that interrupt and compare them."""

from pathlib import Path
from typing import Any

from neol.rollout.reference import ReferenceEngine
from neol.run.evolution import Evolution, Generation
from neol.run.record import Record
from neol.run.runner import run_block
from neol.run.single import OnGeneration
from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec


def run_spec(method: str = "oja", seed: int = 0, *overrides: str, **changes: object) -> RunSpec:
    """A tiny CartPole run."""
    configuration = load_configuration(
        "smoke",
        ["tasks.cartpole.max_steps=40", "evaluation.held_out_episodes=3", *overrides],
    )
    settings = {
        "task": "cartpole",
        "method": method,
        "population": 8,
        "learning_rate": None if method.startswith("neat") else 0.25,
        "generations": 4,
        "seed": seed,
    }
    return configuration.run_spec(**(settings | changes))


SPEC = run_spec()


def evolve(spec: RunSpec) -> Evolution:
    evolution = Evolution.begin(spec, 4, 2)
    engine = ReferenceEngine(spec.task)
    list(evolution.run(engine))
    engine.close()
    return evolution


def started(spec: RunSpec, generations: int) -> Evolution:
    """A run after its first generations."""
    evolution, engine = Evolution.begin(spec, 4, 2), ReferenceEngine(spec.task)
    for _ in range(generations):
        evolution.step(engine)
    engine.close()
    return evolution


def block(output: Path, spec: RunSpec = SPEC, seeds: tuple[int, ...] = (0, 1), **kw: Any) -> Record:
    return run_block(spec, seeds, output, engine="reference", **kw)


def result(record: Record) -> object:
    """Return a record without costs and provenance: the part that depends only on the spec."""
    timeless: list[dict[str, Any]] = [
        info.model_dump(exclude={"wall_seconds", "cpu_seconds", "provenance", "engine"})
        for info in record.seeds
    ]
    return record.spec, record.table.to_pydict(), timeless


def killer(seed: int, generation: int, error: type[BaseException]) -> OnGeneration:
    """Return a callback that stops a block after a generation of a seed."""

    def stop(current: int, done: Generation) -> None:
        if (current, done.generation) == (seed, generation):
            raise error

    return stop


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.rglob("*"))
