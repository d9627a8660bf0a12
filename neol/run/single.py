"""One run: a seed from its start, or its checkpoint, to its champion."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from neol.base.errors import UserError
from neol.neat.genome import Genome
from neol.rollout import Engine
from neol.rollout.environment import network_size
from neol.run.checkpoint import Past, read_checkpoint, write_checkpoint
from neol.run.evolution import Evolution, Generation
from neol.run.provenance import provenance
from neol.spec.run_spec import RunSpec

OnGeneration = Callable[[int, Generation], None]
"""Callback that gets the seed and each completed generation."""


@dataclass(frozen=True, slots=True)
class SeedResult:
    """Result of one run."""

    spec: RunSpec
    history: tuple[Generation, ...]
    champion: Genome
    held_out_returns: npt.NDArray[np.float64]
    """float64[episodes], NaN where an episode failed."""
    digest: str
    """Digest of the trajectory."""
    inputs: int
    outputs: int
    engine: str
    past: Past
    """Cost and provenance."""


def run_seed(
    spec: RunSpec,
    engine: Engine,
    *,
    checkpoint: Path | None = None,
    checkpoint_every: int = 10,
    on_generation: OnGeneration | None = None,
) -> SeedResult:
    """Run one seed to its end, from its checkpoint if there is one.

    Checkpoints are written after every `checkpoint_every` generations, and for the last completed
    generation if the run ends early for any reason. Raises UserError if the environment
    misbehaves, or if all evaluations of the run failed.
    """
    if checkpoint is not None and checkpoint.exists():
        evolution, before = read_checkpoint(checkpoint, spec)
    else:
        evolution, before = Evolution.begin(spec, *network_size(spec.task)), Past()
    wall, cpu = time.perf_counter(), time.process_time()
    made_by = provenance().after(before.provenance)

    def past() -> Past:
        return Past(
            before.wall_seconds + time.perf_counter() - wall,
            before.cpu_seconds + time.process_time() - cpu,
            made_by,
        )

    saved = evolution.generation

    def save() -> None:
        nonlocal saved
        if checkpoint is not None and evolution.generation > saved:
            write_checkpoint(checkpoint, evolution, past())
            saved = evolution.generation

    try:
        for generation in evolution.run(engine):
            if evolution.generation % checkpoint_every == 0:
                save()
            if on_generation is not None:
                on_generation(spec.seed, generation)
        held_out_returns = evolution.held_out_returns(engine)
    except BaseException as error:
        save()
        if isinstance(error, UserError):
            number = evolution.generation + 1
            place = "held-out episodes" if evolution.finished else f"generation {number}"
            raise UserError(f"seed {spec.seed}, {place}: {error}") from error
        raise
    last = evolution.state.history[-1]
    if last.failed_evaluations == last.evaluations:
        save()
        raise UserError(
            f"seed {spec.seed}: all {last.evaluations} evaluations failed: {spec.task.environment} "
            "gives observations or rewards that are not finite, or weights grow without bound; "
            "fix it, or choose another learning rate, and begin again"
        )
    return SeedResult(
        spec=spec,
        history=evolution.state.history,
        champion=evolution.champion(),
        held_out_returns=held_out_returns,
        digest=evolution.state.digest,
        inputs=evolution.reproduction.inputs,
        outputs=evolution.reproduction.outputs,
        engine=engine.name,
        past=past(),
    )
