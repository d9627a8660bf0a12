"""Whether records lie where they belong: the manifest's entries, the budget's names of files."""

import os
from collections.abc import Iterable, Iterator
from functools import cache, cached_property
from pathlib import Path

from neol import manifest, sensitivity
from neol.campaign import RESULTS, Block, blocks, run_specs
from neol.errors import UserError
from neol.manifest import Entry, read_manifest
from neol.record import Record
from neol.records import first_difference
from neol.sensitivity import Trial
from neol.spec import Configuration, RunSpec, budgets, load_configuration


def absolute(path: Path) -> Path:
    """From the root on, so that a result does not depend on the folder one stands in."""
    return Path(os.path.abspath(path))  # noqa: PTH100  (without following links, as resolve does)


class Places:
    """What a budget of `config/` has, by path below its folder; nothing for any other budget."""

    def __init__(self, budget: str | None) -> None:
        self.budget = budget
        self.known = budget in budgets()

    @cached_property
    def blocks(self) -> dict[str, Block]:
        """The records of its cells."""
        if not self.known:
            return {}
        return {self._below(block): block for block in blocks(self._configuration)}

    def find(self, name: str) -> tuple[RunSpec, range] | None:
        """What a record of this name is made of, and its seeds."""
        if block := self.blocks.get(name):
            return run_specs(self._configuration, block)[0], block.seeds
        if trial := self._trials.get(name):
            return trial.spec, trial.seeds
        return None

    @cached_property
    def _trials(self) -> dict[str, Trial]:
        """The records of its sensitivity study, which take longer to list."""
        return {
            self._below(trial): trial
            for variant in sensitivity.variants()
            for trial in sensitivity.trials(self._configuration, variant)
        }

    @cached_property
    def _configuration(self) -> Configuration:
        assert self.budget is not None
        return load_configuration(self.budget)

    def _below(self, place: Block | Trial) -> str:
        return place.record.relative_to(RESULTS / f"{self.budget}").as_posix()


class ManifestFolder:
    """A folder with a manifest, and what should lie in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.damage: str | None = None
        """What is wrong with the manifest itself; nothing else is then known."""
        self._entries: dict[str, Entry] = {}
        self._places = Places(None)
        path = folder / manifest.NAME
        try:
            content = read_manifest(folder)
        except UserError as error:
            self.damage = str(error).removeprefix(f"{path}: ")
        else:
            self._places = Places(content.budget)
            self._entries = {entry.path: entry for entry in content.records}

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
        for name in self._places.blocks:
            if name not in self._entries and self.folder / name not in there:
                meaning = f"missing, and {manifest.NAME} leaves it out, but budget "
                meaning += f"{self._places.budget} has it: dropped, or not yet run by then"
                yield self.folder / name, meaning

    def _misplaced(self, record: Record, entry: Entry) -> Iterator[str]:
        """Whether it is the record that its budget has in this place."""
        budget = self._places.budget
        if record.budget != budget:
            yield f"of budget {record.budget}, its folder's is {budget}"
        elif self._places.known:
            place = self._places.find(entry.path)
            if place is None:
                yield f"budget {budget} has no record of this name"
                return
            spec, seeds = place
            stored = record.spec.without_seed()
            if difference := first_difference(stored, spec):
                yield f"not what budget {budget} has here: {difference}"
            if entry.seeds != tuple(seeds):
                there = f"{seeds[0]} to {seeds[-1]}"
                yield f"holds seeds {list(entry.seeds)}, here belong {there}"


class ManifestFolders:
    """The folders with a manifest at, above and below absolute paths, each read once."""

    def __init__(self) -> None:
        self._folder = cache(ManifestFolder)

    def above(self, path: Path) -> ManifestFolder | None:
        """The nearest above a path."""
        for folder in path.parents:
            if (folder / manifest.NAME).exists():
                return self._folder(folder)
        return None

    def around(self, path: Path) -> list[ManifestFolder]:
        """Those at and below a path and the nearest above it."""
        above = self.above(path)
        below = [self._folder(each.parent) for each in sorted(path.rglob(manifest.NAME))]
        return below + ([above] if above else [])
