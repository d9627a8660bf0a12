"""Replays: runs repeated from their seeds and compared with their records, bit for bit.

docs/verification.md explains on which machines bits are equal, and so what a difference means.
"""

import contextlib
import math
import random
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
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
    """Number of repeated generations; 0 for held-out episodes."""
    problem: Problem | None
    """The first value that differs; None if every bit is equal."""
    whole: bool = True
    """Whether the run was repeated to its end, not only to the deadline."""
    played: bool = True
    """Whether it could be repeated; otherwise the problem says why not."""


@dataclass(frozen=True, slots=True)
class Coverage:
    """Share of records that was repeated to the end, and so the chance to find a forgery."""

    runs: int
    of_runs: int
    cells: int
    """Number of cells of these runs."""
    of_cells: int

    def __str__(self) -> str:
        run, cell = self.runs / self.of_runs, self.cells / self.of_cells
        return f"one forged run is found with a chance of {run:.1%}, one forged cell of {cell:.1%}"


def coverage(cells: Mapping[Run, str], repeated: Iterable[Run]) -> Coverage:
    """Return the coverage by the repeated runs; `cells` has the cell of every run."""
    found = {run for run in repeated if run in cells}
    names = {cells[run] for run in found}
    return Coverage(len(found), len(cells), len(names), len(set(cells.values())))


def draw(cells: Mapping[Run, str], seed: int) -> list[Run]:
    """Return all runs in a random order that gives all cells equal weight.

    First comes one run of each cell, in a random order, then a second of each, and so on.
    """
    chance = random.Random(seed)
    every = sorted(cells)
    chance.shuffle(every)
    counts = Counter[str]()
    rounds: dict[int, list[Run]] = {}
    for run in every:
        rounds.setdefault(counts[cells[run]], []).append(run)
        counts[cells[run]] += 1
    return [run for number in sorted(rounds) for run in rounds[number]]


def replay(run: Run, generations: int | None = None, deadline: float = math.inf) -> Replay:
    """Repeat a run's first generations, or all of it.

    With the last generation, digest, champion and held-out episodes are compared too. At the
    deadline, a time of `time.monotonic`, it ends with the current generation. Raises UserError
    for an unknown rule or environment.
    """
    record, info, evolution = _begin(run)
    last = len(record.rows_of(info.seed)["generation"])
    asked = min(generations or last, last)
    done = 0
    with contextlib.closing(make_engine(evolution.spec.task)) as engine:
        for done in range(1, asked + 1):
            values = _generation(record, info, evolution, engine)
            if problem := _first_difference(run, values):
                return Replay(done, problem)
            if done < asked and time.monotonic() >= deadline:
                return Replay(done, None, whole=False)
        if done < last:
            return Replay(done, None, whole=False)
        return Replay(done, _first_difference(run, _end(info, evolution, engine)))


def replay_champion(run: Run) -> Replay:
    """Repeat the held-out episodes of a run's champion. Raises UserError as `replay` does."""
    _, info, evolution = _begin(run)
    champion = Population.of([info.champion.genome()])
    evolution.state = evolution.state._replace(population=champion)
    with contextlib.closing(make_engine(evolution.spec.task)) as engine:
        return Replay(0, _first_difference(run, _held_out(info, evolution, engine)))


def attempt(play: Callable[..., Replay], run: Run, *how: object) -> Replay:
    """Return a replay of a run by `play`; that it cannot be repeated is a problem too."""
    try:
        return play(run, *how)
    except UserError as error:
        path, seed = run
        problem = Problem(path, f"cannot be repeated: {error}", seed)
        return Replay(0, problem, whole=False, played=False)


def _begin(run: Run) -> tuple[Record, SeedInfo, Evolution]:
    """Return a run's record and results, and the run before its first generation."""
    path, seed = run
    record = read_record(path)
    info, spec = record.info(seed), record.spec_of(seed)
    inputs, outputs = network_size(spec.task)
    if (inputs, outputs) != (info.inputs, info.outputs):
        raise UserError(f"{spec.task.environment} has {inputs} inputs and {outputs} outputs")
    return record, info, Evolution.begin(spec, inputs, outputs)


def _generation(
    record: Record, info: SeedInfo, evolution: Evolution, engine: Engine
) -> Iterator[Value]:
    """Yield the stored values of a run's next generation beside the replayed ones."""
    stored = record.rows_of(info.seed)
    row = evolution.step(engine)
    for column in COLUMNS:
        old = stored[column][row.generation - 1].item()
        yield row.generation, column, old, getattr(row, column)


def _end(info: SeedInfo, evolution: Evolution, engine: Engine) -> Iterator[Value]:
    """Yield the stored values of a run's end beside the replayed ones."""
    yield None, "digest", info.digest, evolution.state.digest
    champion = Champion.of(evolution.champion())
    for name, old in info.champion:
        yield None, f"champion.{name}", old, getattr(champion, name)
    yield from _held_out(info, evolution, engine)


def _held_out(info: SeedInfo, evolution: Evolution, engine: Engine) -> Iterator[Value]:
    again = HeldOut.of(evolution.held_out_returns(engine))
    yield None, "held_out.returns", info.held_out.returns, again.returns


def _first_difference(run: Run, values: Iterable[Value]) -> Problem | None:
    path, seed = run
    for generation, column, old, new in values:
        if _differ(old, new):
            column, old, new = _item(column, old, new)
            shown = f"{_short(old)} stored, {_short(new)} replayed"
            return Problem(path, MEANING, seed, generation, column, shown)
    return None


def _differ(old: object, new: object) -> bool:
    return repr(old) != repr(new)  # distinguishes -0.0 from 0.0, and all other floats


def _item(column: str, old: object, new: object) -> tuple[str, object, object]:
    """Return the first item that differs, if both values are sequences of equal length."""
    while isinstance(old, tuple) and isinstance(new, tuple) and len(old) == len(new):
        pairs = enumerate(zip(old, new, strict=True))
        place, (old, new) = next(each for each in pairs if _differ(*each[1]))
        column = f"{column}[{place}]"
    return column, old, new


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
