"""Replays: runs repeated from their seeds and compared with their records, bit for bit.

docs/verification.md has how far bits travel, and so what a difference can mean.
"""

import contextlib
import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from neol.base.errors import UserError
from neol.neat.population import Population
from neol.rollout import Engine, make_engine
from neol.rollout.environment import network_size
from neol.run.evolution import COLUMNS, Evolution
from neol.run.record import Champion, HeldOut, Record, SeedInfo
from neol.run.record_file import read_record
from neol.study.verification.check import Problem

Run = tuple[Path, int]
"""A record and one of its seeds."""
Value = tuple[int | None, str, object, object]
"""Generation and column of a stored value, that value, and the replayed one."""

MEANING = "edited, made by other code, or by a machine that rounds differently"


@dataclass(frozen=True, slots=True)
class Replay:
    """A run, or its champion's held-out episodes, repeated until a value differs."""

    generations: int
    """How many were repeated; 0 for held-out episodes."""
    problem: Problem | None
    """The first value that differs; None where every bit is the same."""


def draw(runs: Iterable[Run], count: int, seed: int) -> list[Run]:
    """So many of the runs at random, each once; all of them if there are no more."""
    every = sorted(runs)
    return sorted(random.Random(seed).sample(every, min(count, len(every))))


def replay(run: Run, generations: int) -> Replay:
    """Repeat a run's first generations; with its last one, digest and champion are compared too.

    Raises UserError for a rule or an environment that is not known here.
    """
    record, info, evolution = _begin(run)
    generations = min(generations, len(record.rows_of(info.seed)["generation"]))
    with contextlib.closing(make_engine(evolution.spec.task)) as engine:
        values = _values(record, info, evolution, engine, generations)
        problem = _first_difference(run, values)
    return Replay((problem and problem.generation) or generations, problem)


def replay_champion(run: Run) -> Replay:
    """Repeat the held-out episodes of a run's champion. Raises UserError as `replay` does."""
    _, info, evolution = _begin(run)
    champion = Population.of([info.champion.genome()])
    evolution.state = evolution.state._replace(population=champion)
    with contextlib.closing(make_engine(evolution.spec.task)) as engine:
        again = HeldOut.of(evolution.held_out_returns(engine))
    returns = (None, "held_out.returns", info.held_out.returns, again.returns)
    return Replay(0, _first_difference(run, [returns]))


def _begin(run: Run) -> tuple[Record, SeedInfo, Evolution]:
    """What is stored of a run, and the run before its first generation."""
    path, seed = run
    record = read_record(path)
    info, spec = record.info(seed), record.spec_of(seed)
    inputs, outputs = network_size(spec.task)
    if (inputs, outputs) != (info.inputs, info.outputs):
        raise UserError(f"{spec.task.environment} has {inputs} inputs and {outputs} outputs")
    return record, info, Evolution.begin(spec, inputs, outputs)


def _values(
    record: Record, info: SeedInfo, evolution: Evolution, engine: Engine, generations: int
) -> Iterator[Value]:
    """All that is stored of a run's first generations, beside what they give now."""
    stored = record.rows_of(info.seed)
    for number in range(generations):
        row = evolution.step(engine)
        for column in COLUMNS:
            yield number + 1, column, stored[column][number].item(), getattr(row, column)
    if generations == len(stored["generation"]):
        yield None, "digest", info.digest, evolution.state.digest
        champion = Champion.of(evolution.champion())
        for name, old in info.champion:
            yield None, f"champion.{name}", old, getattr(champion, name)


def _first_difference(run: Run, values: Iterable[Value]) -> Problem | None:
    path, seed = run
    for generation, column, old, new in values:
        if _differ(old, new):
            column, old, new = _item(column, old, new)
            shown = f"{_short(old)} stored, {_short(new)} replayed"
            return Problem(path, MEANING, seed, generation, column, shown)
    return None


def _differ(old: object, new: object) -> bool:
    return repr(old) != repr(new)  # which tells -0.0 from 0.0 and every two floats apart


def _item(column: str, old: object, new: object) -> tuple[str, object, object]:
    """The first item that differs, where both values are sequences of the same length."""
    while isinstance(old, tuple) and isinstance(new, tuple) and len(old) == len(new):
        pairs = enumerate(zip(old, new, strict=True))
        place, (old, new) = next(each for each in pairs if _differ(*each[1]))
        column = f"{column}[{place}]"
    return column, old, new


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
