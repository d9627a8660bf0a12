"""Whether records lie where they belong: the manifest's entries, the budget's names of files."""

import os
from collections.abc import Iterable, Iterator
from functools import cache, partial
from pathlib import Path

from neol.errors import UserError
from neol.files import files_below
from neol.jobs import SENSITIVITY, Job
from neol.record import Record
from neol.records import first_difference
from neol.verification import manifest
from neol.verification.manifest import Entry, Manifest, read_manifest, records_of


def absolute(path: Path) -> Path:
    """From the root on, so that a result does not depend on the folder one stands in."""
    return Path(os.path.abspath(path))  # noqa: PTH100  (without following links, as resolve does)


class Budgets:
    """What the budgets of `config/` have, each listed once."""

    def __init__(self) -> None:
        self._jobs = cache(records_of)

    def jobs(self, budget: str | None) -> dict[str, Job]:
        """The records of a budget, by path below its folder; none for one that is not known."""
        return self._jobs(budget)

    def cells(self, budget: str | None) -> list[str]:
        """Those of its cells, its sensitivity study left out."""
        return [name for name, job in self.jobs(budget).items() if job.part != SENSITIVITY]


class ManifestFolder:
    """A folder with a manifest, and what should lie in it."""

    def __init__(self, folder: Path, budgets: Budgets) -> None:
        self.folder = folder
        self.damage: str | None = None
        """What is wrong with the manifest itself; nothing else is then known."""
        self._manifest = Manifest(budget=None, records=())
        self._budgets = budgets
        path = folder / manifest.NAME
        try:
            self._manifest = read_manifest(folder)
        except UserError as error:
            self.damage = str(error).removeprefix(f"{path}: ")
        self.budget = self._manifest.budget
        self._entries = {entry.path: entry for entry in self._manifest.records}

    def problems(self, path: Path, content: bytes, record: Record) -> Iterator[str]:
        """What is wrong with the place here of a record, read from this content."""
        if self.damage:
            return
        now = Entry.of(path.relative_to(self.folder).as_posix(), content, record)
        entry = self._entries.get(now.path)
        if entry is None:
            twin = [other.path for other in self._entries.values() if other.sha256 == now.sha256]
            moved = f" but as {twin[0]}: moved or copied" if twin else ""
            yield f"not in {manifest.NAME}{moved}"
        elif entry.sha256 != now.sha256:
            yield f"its SHA-256 is not that in {manifest.NAME}: changed or exchanged since"
        else:
            for name, stored in entry:
                if stored != getattr(now, name):
                    yield f"{name} in {manifest.NAME} is another: the manifest was edited"
        yield from self._misplaced(record, now)

    def missing(self, there: Iterable[Path]) -> Iterator[tuple[Path, str]]:
        """Records that are not there, and how that is known."""
        there = set(there)
        for name in self._entries:
            if self.folder / name not in there:
                meaning = f"missing, {manifest.NAME} names it; restore it or run anew"
                yield self.folder / name, meaning
        for name in self._all_or_nothing():
            if name not in self._entries and self.folder / name not in there:
                meaning = f"missing, and {manifest.NAME} leaves it out, but budget "
                meaning += f"{self.budget} has it: dropped, or not yet run by then"
                yield self.folder / name, meaning

    def _all_or_nothing(self) -> Iterator[str]:
        """The records that must be there: a sensitivity study may be left out as a whole."""
        jobs, cells = self._budgets.jobs(self.budget), self._budgets.cells(self.budget)
        must = jobs if self._entries.keys() & (jobs.keys() - cells) else cells
        return (name for name in must if self._manifest.covers(jobs[name]))

    def _misplaced(self, record: Record, entry: Entry) -> Iterator[str]:
        """Whether it is the record that its budget has in this place."""
        jobs = self._budgets.jobs(self.budget)
        if record.budget != self.budget:
            yield f"of budget {record.budget}, its folder's is {self.budget}"
        elif jobs:
            job = jobs.get(entry.path)
            if job is None:
                yield f"budget {self.budget} has no record of this name"
                return
            if not self._manifest.covers(job):
                tasks = ", ".join(self._manifest.tasks)
                yield f"of task {job.spec.task.name}, {manifest.NAME} speaks for {tasks} alone"
            if difference := first_difference(record.spec.without_seed(), job.spec):
                yield f"not what budget {self.budget} has here: {difference}"
            if entry.seeds != tuple(job.seeds):
                there = f"{job.seeds[0]} to {job.seeds[-1]}"
                yield f"holds seeds {list(entry.seeds)}, here belong {there}"


class ManifestFolders:
    """The folders with a manifest at, above and below absolute paths, each read once."""

    def __init__(self, budgets: Budgets) -> None:
        self._folder = cache(partial(ManifestFolder, budgets=budgets))

    def above(self, path: Path) -> ManifestFolder | None:
        """The nearest above a path."""
        for folder in path.parents:
            if (folder / manifest.NAME).exists():
                return self._folder(folder)
        return None

    def around(self, path: Path) -> list[ManifestFolder]:
        """Those at and below a path and the nearest above it."""
        above = self.above(path)
        manifests = files_below(path, manifest.NAME) if path.is_dir() else ()
        below = [self._folder(each.parent) for each in manifests]
        return below + ([above] if above else [])
