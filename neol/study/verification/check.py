"""Checks of stored records, in milliseconds each; no run is repeated.

Listing the records of a campaign, for a folder with a manifest, takes longer and is done once.

Beside this: `plausible` has what a run's values can be, `manifest` what lies in a folder, `history`
which commits there are, `replays` repeats a run, and `repetition` draws which.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from neol.base.errors import UserError, printable
from neol.base.files import read_bounded
from neol.run.record_file import MAX_RECORD_BYTES, parse_record, records_below
from neol.study.campaign.jobs import SENSITIVITY
from neol.study.verification import history, manifest
from neol.study.verification.manifest import absolute
from neol.study.verification.manifest_folder import Campaigns, ManifestFolders
from neol.study.verification.plausible import impossible_values

FEW = 3
"""Number of campaigns whose shares are noted one by one."""


@dataclass(frozen=True, slots=True)
class Problem:
    """A finding in one line: its place, the values, their meaning."""

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
        parts = (str(self.path), place, self.values, self.meaning)
        return printable(": ".join(filter(None, parts)))


@dataclass(frozen=True, slots=True)
class Checked:
    """Result of a record's check."""

    path: Path
    findings: tuple[Problem, ...]
    seeds: tuple[int, ...] = ()
    """Seeds of its runs; none if the record cannot be used."""
    cell: str = ""
    """Campaign and specification, which its runs share with those of other seeds."""


class Verification:
    """Check of records, also those below folders, and of the manifests that list them.

    Raises UserError if there is nothing to check.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self._roots = {absolute(path): path for path in paths}
        self._campaigns = Campaigns()
        self._folders = ManifestFolders(self._campaigns)
        records: dict[Path, None] = {}
        for root, path in self._roots.items():
            if not path.exists():
                raise UserError(f"{path}: no such file or folder")
            below = list(records_below(root)) if root.is_dir() else [root]
            if not below and not self._folders.around(root):
                raise UserError(f"{path}: contains no records")
            records |= dict.fromkeys(below)
        self.records = list(records)
        """Absolute paths of the records, each once."""
        self._found: dict[str, set[str]] = {}

    def check(self) -> Iterator[Checked]:
        """Check each record by itself and in its place."""
        for path in self.records:
            yield self._check(path)

    def manifest_findings(self) -> Iterator[Problem]:
        """Yield problems of manifests: damage, missing records, incomplete lists, other files."""
        folders = {f.folder: f for root in self._roots for f in self._folders.around(root)}
        for folder in folders.values():
            if folder.damage:
                yield Problem(self._as_given(folder.folder / manifest.NAME), folder.damage)
            for path, meaning in (*folder.missing(self.records), *folder.strays()):
                if any(root in (path, *path.parents) for root in self._roots):
                    yield Problem(self._as_given(path), meaning)

    def notes(self) -> Iterator[str]:
        """Yield notes after the check: shares of campaigns, records without a manifest.

        Of many campaigns, only the number of complete ones is noted.
        """
        whole = {campaign: len(self._campaigns.cells(campaign)) for campaign in self._found}
        if len(whole) > FEW:
            complete = sum(len(found) == whole[each] for each, found in self._found.items())
            yield f"{complete} of {len(whole)} campaigns complete"
        else:
            for campaign, found in self._found.items():
                yield f"{len(found):,} of {whole[campaign]:,} records of {campaign}"
        if history.ancestors() is None:
            yield "commits not looked up: no whole history is here"
        if loose := sum(self._folders.above(path) is None for path in self.records):
            yield f"{loose:,} in no {manifest.NAME} (neol manifest FOLDER writes one)"

    def _check(self, path: Path) -> Checked:
        shown = self._as_given(path)
        try:
            content = read_bounded(path, MAX_RECORD_BYTES)
            record = parse_record(path, content)
        except UserError as error:
            return Checked(shown, (Problem(shown, str(error).removeprefix(f"{path}: ")),))
        findings = [
            Problem(shown, f"{it.meaning}: edited", it.seed, it.generation, it.column, it.values)
            for it in impossible_values(record)
        ]
        folder = self._folders.above(path)
        belongs = {self._campaigns.of_place(path), folder.campaign if folder else None}
        for campaign in sorted(filter(None, belongs - {record.campaign})):
            findings.append(Problem(shown, f"of {record.campaign}, its folder is of {campaign}"))
        if folder:
            problems = folder.problems(path, content, record)
            findings += [Problem(shown, problem) for problem in problems]
        if record.campaign is not None:
            tails = {"/".join(path.parts[first:]) for first in range(1, len(path.parts))}
            jobs = self._campaigns.jobs(record.campaign)
            cells = {name for name in tails & jobs.keys() if jobs[name].part != SENSITIVITY}
            if cells:
                self._found.setdefault(record.campaign, set()).update(cells)
        return Checked(
            shown,
            tuple(findings),
            tuple(info.seed for info in record.seeds),
            f"{record.campaign} {record.spec.digest()}",
        )

    def _as_given(self, path: Path) -> Path:
        """Return a path below a given one in the form in which that was given."""
        for root, given in self._roots.items():
            if root in (path, *path.parents):
                return given / path.relative_to(root)
        return path
