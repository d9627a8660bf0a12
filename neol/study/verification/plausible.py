"""Plausibility of a record: values that no run can have, found without playing."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np
import numpy.typing as npt

from neol.run.evolution import COLUMNS
from neol.run.provenance import Provenance
from neol.run.record import HeldOut, Record, SeedInfo
from neol.spec.observations import size_of
from neol.spec.run_spec import RunSpec
from neol.study.verification.returns import Returns, returns_of

ROUNDING = 1e-9
"""Relative tolerance: smaller differences may come from another order of addition."""
NEEDED_VERSIONS = ("python", "numpy", "numba", "gymnasium")
"""Packages that every run was made with."""

Rows = dict[str, Any]
"""The columns of a run."""
Check = tuple[str, npt.NDArray[np.bool_], str]
"""Column, whether each generation's value is possible, and the meaning of an impossible one."""


@dataclass(frozen=True, slots=True)
class Impossible:
    """A value that no run can have: its place, the value, its meaning."""

    meaning: str
    seed: int
    generation: int | None = None
    column: str = ""
    values: str = ""


def impossible_values(record: Record) -> Iterator[Impossible]:
    """Yield values that no run can have, in an undamaged record."""
    for info in record.seeds:
        yield from _of_run(record.spec, record.rows_of(info.seed), info)
    yield from _repeated(record)


def _of_run(spec: RunSpec, rows: Rows, info: SeedInfo) -> Iterator[Impossible]:
    environment, seed = spec.task.environment, info.seed
    size = size_of(environment)
    if size and size != (info.inputs, info.outputs):
        values = f"{info.inputs} inputs, {info.outputs} outputs"
        yield Impossible(f"{environment} has {size[0]} and {size[1]}", seed, values=values)
    returns = returns_of(spec.task)
    checks: list[Check] = [(name, np.isfinite(rows[name]), "not finite") for name in rows]
    if all(finite.all() for _, finite, _ in checks):
        checks += _checks(rows, spec, info)
        checks += _fitness_checks(rows, spec, returns) if returns else ()
    for column, possible, meaning in checks:
        if not possible.all():
            first = int(np.argmin(possible))
            yield Impossible(meaning, seed, first + 1, column, repr(rows[column][first].item()))
    yield from _of_held_out(info, returns)
    for column, value, meaning in _of_provenance(info.provenance):
        yield Impossible(meaning, seed, None, f"provenance.{column}", value)


def _checks(rows: Rows, spec: RunSpec, info: SeedInfo) -> Iterator[Check]:
    """Yield checks that hold in every environment."""
    best, mean, sd = rows["best_fitness"], rows["mean_fitness"], rows["sd_fitness"]
    slack = ROUNDING * (np.abs(best) + np.abs(mean) + np.abs(sd))
    yield "best_fitness", best >= mean - slack, "below the mean"
    # Samuelson's inequality: none of P values is further from the mean.
    reach = np.sqrt(spec.population - 1) * sd
    yield "best_fitness", best - mean <= reach + slack, "too far from the mean for this spread"
    evaluations = spec.population * rows["generation"]
    yield "evaluations", rows["evaluations"] == evaluations, "not P times the generation"
    steps = np.diff(rows["env_steps"], prepend=0)
    most = spec.population * spec.evaluation.episodes * spec.task.max_steps
    yield "env_steps", (steps >= 0) & (steps <= most), "not what P x N episodes can take"
    failed = np.diff(rows["failed_evaluations"], prepend=0)
    yield "failed_evaluations", (failed >= 0) & (failed <= spec.population), "not 0 to P more"
    yield "species", (rows["species"] >= 1) & (rows["species"] <= spec.population), "not 1 to P"
    for column in ("nodes_mean", "nodes_best"):
        yield column, rows[column] >= info.outputs, "fewer than there are outputs"
    for column in ("sd_fitness", "connections_mean", "connections_best", "weight_change_mean"):
        yield column, rows[column] >= 0, "negative"
    if not spec.plasticity.learns:
        change = rows["weight_change_mean"]
        yield "weight_change_mean", change == 0, "weights changed, but there is no rule"
    limit = spec.evaluation.step_limit
    over = rows["generation"] == spec.generations
    if limit is not None:
        over |= rows["env_steps"] >= limit
    last = rows["generation"] == len(over)
    yield "env_steps", over == last, "the run does not end where its step limit is reached"
    enabled = sum(connection[-1] for connection in info.champion.connections)
    for column, size in (
        ("nodes_best", len(info.champion.nodes)),
        ("connections_best", enabled),
    ):
        yield column, (rows[column] == size) | ~last, f"its champion has {size}"


def _fitness_checks(rows: Rows, spec: RunSpec, returns: Returns) -> Iterator[Check]:
    """Yield checks of fitness, for generations without failed evaluations."""
    best, mean = rows["best_fitness"], rows["mean_fitness"]
    failed = np.diff(rows["failed_evaluations"], prepend=0) != 0
    for column in ("best_fitness", "mean_fitness"):
        possible = (rows[column] >= returns.lowest) & (rows[column] <= returns.highest)
        meaning = f"not between {returns.lowest:g} and {returns.highest:g}"
        yield column, possible | failed, f"{meaning}, as all returns of {spec.task.environment}"
    if returns.each_step is not None:
        episodes = spec.evaluation.episodes
        steps = best * episodes / returns.each_step
        whole = np.abs(steps - np.round(steps)) <= ROUNDING * np.abs(steps)
        yield "best_fitness", whole | failed, "not a mean of whole numbers"
        steps = np.diff(rows["env_steps"], prepend=0)
        paid = mean * spec.population * episodes / returns.each_step
        follows = np.abs(paid - steps) <= ROUNDING * np.abs(paid)
        yield "env_steps", follows | failed, "not what the mean fitness was paid for"


def _of_held_out(info: SeedInfo, returns: Returns | None) -> Iterator[Impossible]:
    stored = info.held_out
    for place, value in enumerate(stored.returns):
        if value is None or returns is None:
            continue
        fraction = returns.each_step and (value / returns.each_step) % 1
        if fraction or not returns.lowest <= value <= returns.highest:
            meaning = "not what an episode can return"
            yield Impossible(meaning, info.seed, None, f"held_out.returns[{place}]", repr(value))
            break
    right = HeldOut.of(np.array([np.nan if r is None else r for r in stored.returns]))
    for column in ("mean", "sd"):
        old, new = getattr(stored, column), getattr(right, column)
        if old != new:
            meaning, values = "does not follow from the returns", f"{old!r} stored, {new!r} right"
            yield Impossible(meaning, info.seed, None, f"held_out.{column}", values)


def _of_provenance(made: Provenance) -> Iterator[tuple[str, str, str]]:
    """Yield each wrong key with its value and its error."""
    for package in NEEDED_VERSIONS:
        if not made.versions.get(package):
            yield f"versions.{package}", "", "no run was made without it"
    try:
        when = datetime.fromisoformat(made.time)
    except ValueError:
        when = None
    if when is None or when.utcoffset() is None:
        yield "time", repr(made.time), "not a time as ISO 8601 has it, with its zone"


def _repeated(record: Record) -> Iterator[Impossible]:
    """Yield runs that appear under two seeds; even the first weights of two runs must differ."""
    contents: dict[str, dict[int, Any]] = {"digest": {i.seed: i.digest for i in record.seeds}}
    if record.spec.neat.weight_init_sd > 0:
        contents["champion"] = {
            info.seed: (info.champion.nodes, info.champion.connections) for info in record.seeds
        }
        rows = {info.seed: record.rows_of(info.seed) for info in record.seeds}
        contents["rows"] = {
            seed: tuple(mine[column].tobytes() for column in COLUMNS)
            for seed, mine in rows.items()
            if len(set(mine["mean_fitness"].tolist())) > 2  # fewer can agree by chance
        }
    for what, of_seed in contents.items():
        counts = Counter(of_seed.values())
        twins = [seed for seed, content in of_seed.items() if counts[content] > 1]
        if twins:
            values = f"as of seed {twins[0]}"
            yield Impossible("one run under two seeds", twins[1], None, what, values)
