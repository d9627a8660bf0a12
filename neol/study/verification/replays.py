"""Replays: runs repeated from their seeds and compared with their records, bit for bit.

docs/verification.md has how far bits travel, and so what a difference can mean.
"""

import contextlib
import hashlib
import math
import platform
import random
from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from neol.base.errors import UserError
from neol.neat.population import Population
from neol.rollout import make_engine
from neol.rollout.reference import network_size
from neol.run.evolution import COLUMNS, Evolution
from neol.run.provenance import Provenance, provenance
from neol.run.record import Champion, HeldOut, Record, SeedInfo
from neol.run.record_file import read_record
from neol.study.verification.check import ROUNDING, Problem

Run = tuple[Path, int]
"""A record and one of its seeds."""

UNROUNDED = ("nodes_mean", "connections_mean", "nodes_best", "connections_best")
"""In the first generation these are the same on every machine; `evaluations` always is."""

TOGETHER = ("best_fitness", "mean_fitness", "sd_fitness", "env_steps")
"""Another episode shows in several of these, never in one alone."""


@dataclass(frozen=True, slots=True)
class Difference:
    """A value of a record that its replay does not give."""

    generation: int | None
    column: str
    stored: object
    replayed: object

    @property
    def in_last_bits(self) -> bool:
        """Whether rounding explains it."""
        if not (isinstance(self.stored, float) and isinstance(self.replayed, float)):
            return False
        largest = max(abs(self.stored), abs(self.replayed))
        return abs(self.stored - self.replayed) <= ROUNDING * largest


@dataclass(frozen=True, slots=True)
class Replay:
    """A run, or its champion's held-out episodes, repeated."""

    run: Run
    made_by: Provenance
    generations: int
    """How many were repeated; 0 for held-out episodes."""
    complete: bool
    """Whether these were all, so that digest and champion were compared too."""
    differences: tuple[Difference, ...]
    """In the order in which they arose; none where every bit is the same."""


def draw(runs: Iterable[Run], count: int, seed: int) -> list[Run]:
    """So many of the runs at random, each once; all of them if there are no more."""
    every = sorted(runs)
    return sorted(random.Random(seed).sample(every, min(count, len(every))))


def replay(run: Run, generations: int) -> Replay:
    """Repeat a run's first generations; with its last one, digest and champion are compared too.

    Raises UserError for a rule or an environment that is not known here.
    """
    record, info, evolution = _begin(run)
    spec, stored = evolution.spec, record.rows_of(info.seed)
    generations = min(generations, len(stored["generation"]))
    complete = generations == len(stored["generation"])
    differences = []
    with contextlib.closing(make_engine(spec.task)) as engine:
        for number in range(generations):
            row = evolution.step(engine)
            for column in COLUMNS:
                old, new = stored[column][number].item(), getattr(row, column)
                differences += _compare(number + 1, column, old, new)
    if complete:
        differences += _compare(None, "digest", info.digest, evolution.digest)
        new_champion = Champion.of(evolution.champion())
        for name, old in info.champion:
            differences += _compare(None, f"champion.{name}", old, getattr(new_champion, name))
    return Replay(run, info.provenance, generations, complete, tuple(differences))


def replay_champion(run: Run) -> Replay:
    """Repeat the held-out episodes of a run's champion. Raises UserError as `replay` does."""
    _, info, evolution = _begin(run)
    evolution.population = Population.of([info.champion.genome()])
    with contextlib.closing(make_engine(evolution.spec.task)) as engine:
        again = HeldOut.of(evolution.held_out_returns(engine))
    differences = _compare(None, "held_out.returns", info.held_out.returns, again.returns)
    return Replay(run, info.provenance, 0, False, tuple(differences))


def _begin(run: Run) -> tuple[Record, SeedInfo, Evolution]:
    """What is stored of a run, and the run before its first generation."""
    path, seed = run
    record = read_record(path)
    info, spec = record.info(seed), record.spec_of(seed)
    inputs, outputs = network_size(spec.task)
    if (inputs, outputs) != (info.inputs, info.outputs):
        raise UserError(f"{spec.task.environment} has {inputs} inputs and {outputs} outputs")
    return record, info, Evolution.begin(spec, inputs, outputs)


def _compare(generation: int | None, column: str, old: object, new: object) -> list[Difference]:
    """The differences, item by item where both are sequences of the same length."""
    if isinstance(old, tuple) and isinstance(new, tuple) and len(old) == len(new):
        pairs = enumerate(zip(old, new, strict=True))
        return [d for i, (a, b) in pairs for d in _compare(generation, f"{column}[{i}]", a, b)]
    # repr tells -0.0 from 0.0 and every two floats apart
    return [] if repr(old) == repr(new) else [Difference(generation, column, old, new)]


# --- What a difference means --------------------------------------------------------------------


def findings(replays: Sequence[Replay]) -> Iterator[Problem]:
    """The first difference of each replay, and what it means."""
    for each in replays:
        if each.differences:
            first = each.differences[0]
            path, seed = each.run
            values = f"{_short(first.stored)} stored, {_short(first.replayed)} replayed"
            yield Problem(path, _meaning(each), seed, first.generation, first.column, values)


def _meaning(this: Replay) -> str:
    if reason := _beyond_machines(this):
        return f"edited: {reason}"
    here = provenance()
    apart = machine_differences(this.made_by, here)
    code, dirty = "", here.dirty or this.made_by.dirty
    if dirty or here.commit != this.made_by.commit:
        there = this.made_by.code(10)
        code = f", or made by other code (commit {there} there, {here.code(10)} here)"
    if not apart:
        return f"edited{code}: this machine has the same versions, CPU and libc"
    if this.differences[0].in_last_bits:
        return f"this machine computes differently: it begins in the last bits, and {apart}"
    return f"edited{code}, or this machine computes differently: {apart}"


def _beyond_machines(this: Replay) -> str:
    """Why no machine that rounds differently explains it; empty where one may.

    A run that rounds differently need not stay different: what differs may die out.
    """
    first = this.differences[0]
    if first.column == "evaluations" or (first.generation == 1 and first.column in UNROUNDED):
        return "no machine gives another value"
    if all(difference.in_last_bits for difference in this.differences):
        return ""
    if this.complete and "digest" not in {difference.column for difference in this.differences}:
        return "the digest of the trajectory agrees"
    if not this.generations:
        stored = sorted(str(difference.stored) for difference in this.differences)
        replayed = sorted(str(difference.replayed) for difference in this.differences)
        return "these are the right returns in another order" if stored == replayed else ""
    beside = {d.column for d in this.differences if d.generation == first.generation}
    if len(beside) == 1 and first.column in TOGETHER:
        return "the other values of this generation agree"
    return ""


LIBM_DIGEST = "2a7398a8bf48497879c3200015d97ad060bb59f7381eb3d5c7c0aad22b1bdd6c"
"""Digest of sine, cosine, tanh and exp as glibc computes them with fused multiply-adds."""


def libm_digest() -> str:
    """Of the bits of this machine's sine, cosine, tanh and exp at 16,001 points."""
    points = [place / 1000 for place in range(-8000, 8001)]
    digest = hashlib.sha256()
    for function in (math.sin, math.cos, math.tanh, math.exp):
        digest.update(array("d", map(function, points)).tobytes())
    return digest.hexdigest()


def machine_differences(there: Provenance, here: Provenance) -> str:
    """What of two machines may make last bits differ: empty where nothing does."""
    pairs = {
        name: (old, here.versions.get(name))
        for name, old in there.versions.items()
        if name != "neol"
    }
    pairs["CPU"] = there.cpu.partition(" x ")[2], here.cpu.partition(" x ")[2]
    pairs["libc"] = there.libc, here.libc
    if platform.machine() not in there.platform:
        pairs["platform"] = there.platform, here.platform
    if libm_digest() != LIBM_DIGEST:
        pairs["sine or tanh"] = "glibc's with fused multiply-adds", "rounded otherwise"
    return ", ".join(
        f"{name} is {old} there and {new} here" for name, (old, new) in pairs.items() if old != new
    )


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
