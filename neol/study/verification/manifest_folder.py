"""Check of a folder with a manifest: its records, in their places, and no other files."""

from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache, partial
from pathlib import Path

from neol.base.errors import UserError
from neol.base.files import files_below
from neol.run.record import Record, campaign_name
from neol.run.record_file import first_difference
from neol.spec.configuration import budgets
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.jobs import SENSITIVITY, Job
from neol.study.verification.history import unknown_code
from neol.study.verification.manifest import (
    NAME,
    Manifest,
    ManifestEntry,
    governing_folder,
    read_manifest,
    records_of,
)


class Campaigns:
    """Records of the campaigns of `config/`, each campaign listed once."""

    def __init__(self) -> None:
        self._jobs = cache(records_of)
        self._budgets = set(budgets())

    def jobs(self, campaign: str | None) -> dict[str, Job]:
        """Return the records of a campaign by path below its folder; none if it is unknown."""
        return self._jobs(campaign)

    def cells(self, campaign: str | None) -> list[str]:
        """Return the records of its cells, without its sensitivity study."""
        return [name for name, job in self.jobs(campaign).items() if job.part != SENSITIVITY]

    def of_place(self, path: Path) -> str | None:
        """Return the campaign that a path's folder names, such as rare_mutation/demo."""
        parts = path.parts
        for place in reversed(range(len(parts) - 3)):
            if parts[place] == RESULTS.name and parts[place + 2] in self._budgets:
                return campaign_name(parts[place + 1], parts[place + 2])
        return None


class ManifestFolder:
    """A folder with a manifest, and its expected records."""

    def __init__(self, folder: Path, campaigns: Campaigns) -> None:
        self.folder = folder
        self.damage: str | None = None
        """Damage of the manifest itself; the folder cannot be checked then."""
        self._manifest = Manifest(budget=None, records=())
        self._campaigns = campaigns
        path = folder / NAME
        try:
            self._manifest = read_manifest(folder)
        except UserError as error:
            self.damage = str(error).removeprefix(f"{path}: ")
        self.campaign = self._manifest.campaign
        self._entries = {entry.path: entry for entry in self._manifest.records}

    def problems(self, path: Path, content: bytes, record: Record) -> Iterator[str]:
        """Yield problems of the place of a record that was read from this content."""
        if self.damage:
            return
        now = ManifestEntry.of(path.relative_to(self.folder).as_posix(), content, record)
        entry = self._entries.get(now.path)
        if entry is None:
            twin = [other.path for other in self._entries.values() if other.sha256 == now.sha256]
            moved = f" but as {twin[0]}: moved or copied" if twin else ""
            yield f"not in {NAME}{moved}"
        elif entry.sha256 != now.sha256:
            yield f"its SHA-256 is not that in {NAME}: changed or exchanged since"
        else:
            for name, stored in entry:
                if stored != getattr(now, name):
                    yield f"{name} in {NAME} is another: the manifest was edited"
        yield from self._misplaced(record, now)
        reasons = Counter(filter(None, (unknown_code(info.provenance) for info in record.seeds)))
        for reason, runs in reasons.items():
            yield f"{runs} of its {len(record.seeds)} runs: {reason}; make it again"

    def missing(self, there: Iterable[Path]) -> Iterator[tuple[Path, str]]:
        """Yield missing records, and how they are known."""
        there = set(there)
        for name in self._entries:
            if self.folder / name not in there:
                meaning = f"missing, {NAME} names it; restore it or run again"
                yield self.folder / name, meaning
        for name in self._all_or_nothing():
            if name not in self._entries and self.folder / name not in there:
                meaning = f"missing, and {NAME} leaves it out, but {self.campaign} "
                meaning += "has it: dropped, or not yet run by then"
                yield self.folder / name, meaning

    def strays(self) -> Iterator[tuple[Path, str]]:
        """Yield other files than records, and what they mean."""
        partial_at: Path | None = None
        for path in files_below(self.folder, "*"):
            if partial_at in path.parents:
                continue
            if path.is_dir():
                if path.name.endswith(".partial"):
                    partial_at = path
                    yield path, "a run that has not ended: finish it or remove this folder"
            elif path.name == NAME and path.parent != self.folder:
                yield path, f"within the folder of {self.folder / NAME}, which alone counts: remove"
            elif path.suffix != ".parquet" and path != self.folder / NAME:
                yield path, "no record: remove it"

    def _all_or_nothing(self) -> Iterator[str]:
        """Return the required records; a sensitivity study may be omitted as a whole."""
        jobs = self._campaigns.jobs(self.campaign)
        cells = self._campaigns.cells(self.campaign)
        must = jobs if self._entries.keys() & (jobs.keys() - cells) else cells
        return (name for name in must if self._manifest.covers(jobs[name]))

    def _misplaced(self, record: Record, entry: ManifestEntry) -> Iterator[str]:
        """Yield differences from the record that the campaign has in this place."""
        jobs = self._campaigns.jobs(self.campaign)
        if record.campaign == self.campaign and jobs:
            job = jobs.get(entry.path)
            if job is None:
                yield f"{self.campaign} has no record of this name"
                return
            if not self._manifest.covers(job):
                tasks = ", ".join(self._manifest.tasks)
                yield f"of task {job.spec.task.name}, {NAME} covers {tasks} only"
            if difference := first_difference(record.spec.without_seed(), job.spec):
                yield f"not what {self.campaign} has here: {difference}"
            if entry.seeds != tuple(job.seeds):
                there = f"{job.seeds[0]} to {job.seeds[-1]}"
                yield f"contains seeds {list(entry.seeds)}, not {there}"


class ManifestFolders:
    """The folders with a manifest around absolute paths, each read once."""

    def __init__(self, campaigns: Campaigns) -> None:
        self._folder = cache(partial(ManifestFolder, campaigns=campaigns))

    def above(self, path: Path) -> ManifestFolder | None:
        """Return the folder with a manifest that covers a path."""
        folder = governing_folder(path)
        return None if folder is None else self._folder(folder)

    def around(self, path: Path) -> list[ManifestFolder]:
        """Return the folders with a manifest that covers a path or files below it."""
        manifests = files_below(path, NAME) if path.is_dir() else ()
        return list(dict.fromkeys(filter(None, map(self.above, (path, *manifests)))))
