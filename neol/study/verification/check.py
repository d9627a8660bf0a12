"""Verification of records as they lie there, in milliseconds each; no run is repeated.

What a campaign has in a folder with a manifest is listed once and takes longer.

`neol.study.verification.replays` repeats runs, `neol.study.verification.manifest` knows manifests.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from neol.base.errors import UserError
from neol.base.files import read_bounded
from neol.run.record import HeldOut, Record, SeedInfo
from neol.run.record_file import MAX_RECORD_BYTES, parse_record, records_below
from neol.spec.observations import size_of
from neol.spec.run_spec import RunSpec
from neol.study.campaign.jobs import SENSITIVITY
from neol.study.verification import manifest
from neol.study.verification.manifest import Campaigns, ManifestFolders, absolute

ROUNDING = 1e-9
"""Relative: what is smaller may come from adding up in another order."""

Rows = dict[str, Any]
"""The columns of a run."""


@dataclass(frozen=True, slots=True)
class Problem:
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
    findings: tuple[Problem, ...]


class Verification:
    """The check of records, those below folders too, and of the manifests that they stand in.

    Raises UserError where there is nothing to check.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self._roots = {absolute(path): path for path in paths}
        self._campaigns = Campaigns()
        self._folders = ManifestFolders(self._campaigns)
        records: dict[Path, None] = {}
        for root, path in self._roots.items():
            if not path.exists():
                raise UserError(f"{path}: there is no such file or folder")
            below = list(records_below(root)) if root.is_dir() else [root]
            if not below and not self._folders.around(root):
                raise UserError(f"{path}: holds no records")
            records |= dict.fromkeys(below)
        self.records = list(records)
        """Their absolute paths, each once."""
        self._found: dict[str, set[str]] = {}

    def check(self) -> Iterator[Checked]:
        """Each record, by itself and in its place."""
        for path in self.records:
            yield self._check(path)

    def manifest_findings(self) -> Iterator[Problem]:
        """What is wrong with manifests: damaged, naming what is not there, or less than all."""
        folders = {f.folder: f for root in self._roots for f in self._folders.around(root)}
        for folder in folders.values():
            if folder.damage:
                yield Problem(self._as_given(folder.folder / manifest.NAME), folder.damage)
            for path, meaning in folder.missing(self.records):
                if any(root in (path, *path.parents) for root in self._roots):
                    yield Problem(self._as_given(path), meaning)

    def notes(self) -> Iterator[str]:
        """After the check: how much of its campaigns is there, and what no manifest vouches for."""
        for campaign, found in self._found.items():
            all_of_it = len(self._campaigns.cells(campaign))
            yield f"{len(found):,} of {all_of_it:,} records of {campaign}"
        if loose := sum(self._folders.above(path) is None for path in self.records):
            yield f"{loose:,} in no {manifest.NAME} (neol manifest FOLDER writes one)"

    def _check(self, path: Path) -> Checked:
        shown = self._as_given(path)
        try:
            content = read_bounded(path, MAX_RECORD_BYTES)
            record = parse_record(path, content)
        except UserError as error:
            return Checked(shown, (), (Problem(shown, str(error).removeprefix(f"{path}: ")),))
        findings = [finding for info in record.seeds for finding in _check_run(shown, record, info)]
        if folder := self._folders.above(path):
            problems = folder.problems(path, content, record)
            findings += [Problem(shown, problem) for problem in problems]
        if record.campaign is not None:
            tails = {"/".join(path.parts[first:]) for first in range(1, len(path.parts))}
            jobs = self._campaigns.jobs(record.campaign)
            cells = {name for name in tails & jobs.keys() if jobs[name].part != SENSITIVITY}
            if cells:
                self._found.setdefault(record.campaign, set()).update(cells)
        return Checked(shown, tuple(info.seed for info in record.seeds), tuple(findings))

    def _as_given(self, path: Path) -> Path:
        """A path below one that was named, as that was written."""
        for root, given in self._roots.items():
            if root in (path, *path.parents):
                return given / path.relative_to(root)
        return path


def _check_run(path: Path, record: Record, info: SeedInfo) -> Iterator[Problem]:
    """What no run can have come to, sealed or not."""
    rows = record.rows_of(info.seed)
    environment = record.spec.task.environment
    size = size_of(environment)
    if size and size != (info.inputs, info.outputs):
        values = f"{info.inputs} inputs, {info.outputs} outputs"
        meaning = f"{environment} has {size[0]} and {size[1]}: edited"
        yield Problem(path, meaning, info.seed, values=values)
    for column, possible, meaning in _possible(rows, record.spec, info):
        if not possible.all():
            first = int(np.argmin(possible))
            value = repr(rows[column][first].item())
            yield Problem(path, f"{meaning}: edited", info.seed, first + 1, column, value)
    stored = info.held_out
    right = HeldOut.of(np.array([np.nan if r is None else r for r in stored.returns]))
    for column in ("mean", "sd"):
        values = f"{getattr(stored, column)!r} stored, {getattr(right, column)!r} right"
        if getattr(stored, column) != getattr(right, column):
            meaning = "does not follow from the returns: edited"
            yield Problem(path, meaning, info.seed, None, f"held_out.{column}", values)


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
    if not spec.plasticity.learns:
        change = rows["weight_change_mean"]
        yield "weight_change_mean", change == 0, "weights changed, but there is no rule"
    limit = spec.evaluation.step_limit
    over = rows["generation"] == spec.generations
    if limit is not None:
        over |= rows["env_steps"] >= limit
    last = rows["generation"] == len(over)
    yield "env_steps", over == last, "the run ends elsewhere than where its budget is used up"
