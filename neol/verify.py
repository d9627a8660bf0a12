"""Verification of records as they lie there, in milliseconds each; no run is repeated.

`neol.verify_replay` repeats runs, `neol.verify_place` knows manifests.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from neol import manifest
from neol.errors import UserError
from neol.manifest import records_below
from neol.records import HeldOut, Record, SeedInfo, read_record
from neol.spec import RunSpec
from neol.verify_place import Shelf, Shelves

ROUNDING = 1e-9
"""Relative: what is smaller may come from adding up in another order."""

Rows = dict[str, Any]
"""The columns of a run."""


@dataclass(frozen=True, slots=True)
class Finding:
    """Something wrong, in one line: where, which values, what it means."""

    path: Path
    meaning: str
    seed: int | None = None
    generation: int | None = None
    column: str = ""
    values: str = ""

    def __str__(self) -> str:
        seed = "" if self.seed is None else f"seed {self.seed}"
        generation = "" if self.generation is None else f"generation {self.generation}"
        place = ", ".join(filter(None, (seed, generation, self.column)))
        return ": ".join(filter(None, (str(self.path), place, self.values, self.meaning)))


@dataclass(frozen=True, slots=True)
class Checked:
    """A record after its check."""

    path: Path
    seeds: tuple[int, ...]
    """Of its runs; none where it cannot be used."""
    findings: tuple[Finding, ...]


class Verification:
    """The check of a record, or of all below a folder and the manifests that they stand in.

    Raises UserError where there is nothing to check.
    """

    def __init__(self, path: Path) -> None:
        if not path.exists():
            raise UserError(f"{path}: there is no such file or folder")
        self.path = path
        self.records: Sequence[Path] = list(records_below(path)) if path.is_dir() else [path]
        self._shelves = Shelves(path)
        if not self.records and not self._shelves.all(path):
            raise UserError(f"{path}: holds no records")

    def check(self) -> Iterator[Checked]:
        """Each record, by itself and in its place."""
        for path in self.records:
            yield _check(path, self._shelves.of(path))

    def manifest_findings(self) -> Iterator[Finding]:
        """What is wrong with manifests: damaged, not there, naming what is not there."""
        for shelf in self._shelves.all(self.path):
            if shelf.damage:
                yield Finding(shelf.folder / manifest.NAME, shelf.damage)
            for path in shelf.missing(self.path, set(self.records)):
                yield Finding(path, f"missing, {manifest.NAME} names it; restore it or run anew")
        loose = [path for path in self.records if self._shelves.of(path) is None]
        if loose and self.path.is_dir():
            yield Finding(
                loose[0],
                f"in no {manifest.NAME}, so lost or exchanged records go unnoticed; "
                "neol manifest FOLDER writes one",
            )


def _check(path: Path, shelf: Shelf | None) -> Checked:
    try:
        record = read_record(path)
    except UserError as error:
        return Checked(path, (), (Finding(path, str(error).removeprefix(f"{path}: ")),))
    findings = [finding for info in record.seeds for finding in _check_run(path, record, info)]
    if shelf is not None:
        findings += [Finding(path, problem) for problem in shelf.problems(path, record)]
    return Checked(path, tuple(info.seed for info in record.seeds), tuple(findings))


def _check_run(path: Path, record: Record, info: SeedInfo) -> Iterator[Finding]:
    """What no run can have come to, sealed or not."""
    rows = record.rows_of(info.seed)
    for column, possible, meaning in _possible(rows, record.spec, info):
        if not possible.all():
            first = int(np.argmin(possible))
            value = repr(rows[column][first].item())
            yield Finding(path, f"{meaning}: edited", info.seed, first + 1, column, value)
    stored = info.held_out
    right = HeldOut.of(np.array([np.nan if r is None else r for r in stored.returns]))
    for column in ("mean", "sd"):
        values = f"{getattr(stored, column)!r} stored, {getattr(right, column)!r} right"
        if getattr(stored, column) != getattr(right, column):
            meaning = "does not follow from the returns: edited"
            yield Finding(path, meaning, info.seed, None, f"held_out.{column}", values)


def _possible(rows: Rows, spec: RunSpec, info: SeedInfo) -> Iterator[tuple[str, Any, str]]:
    """Column, bool for each generation, and what it means where that is false."""
    best, mean, sd = rows["best_fitness"], rows["mean_fitness"], rows["sd_fitness"]
    for column, values in rows.items():
        yield column, np.isfinite(values), "not finite"
    slack = ROUNDING * (np.abs(best) + np.abs(mean) + np.abs(sd))
    yield "best_fitness", best >= mean - slack, "below the mean"
    # Samuelson's inequality: no value of P is further from the mean.
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
