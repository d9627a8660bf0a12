"""Whether records lie where they belong: the manifest's entries, the budget's names of files."""

from collections.abc import Iterator
from functools import cache, cached_property
from pathlib import Path

from neol import campaign, manifest, sensitivity
from neol.campaign import RESULTS, Block
from neol.errors import UserError
from neol.manifest import Entry, read_manifest
from neol.records import Record, first_difference
from neol.sensitivity import Trial
from neol.spec import Configuration, budgets, load_configuration


class Shelf:
    """A folder with a manifest, and what should lie in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.damage: str | None = None
        """What is wrong with the manifest itself; nothing else is then known."""
        self._entries: dict[str, Entry] = {}
        self._budget: str | None = None
        path = folder / manifest.NAME
        try:
            content = read_manifest(folder)
        except UserError as error:
            self.damage = str(error).removeprefix(f"{path}: ")
        else:
            self._budget = content.budget
            self._entries = {entry.path: entry for entry in content.records}

    def problems(self, path: Path, record: Record) -> Iterator[str]:
        """What is wrong with a record's place here."""
        if self.damage:
            return
        now = Entry.of(path, record, self.folder)
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

    def missing(self, below: Path, there: set[Path]) -> Iterator[Path]:
        """The records that the manifest names below a path and that are not there."""
        for name in self._entries:
            path = self.folder / name
            if path not in there and (path == below or below in path.parents):
                yield path

    def _misplaced(self, record: Record, entry: Entry) -> Iterator[str]:
        """Whether it is the record that its budget has in this place."""
        if record.budget != self._budget:
            yield f"of budget {record.budget}, its folder's is {self._budget}"
        elif self._budget in budgets():
            place = self._blocks.get(entry.path) or self._trials.get(entry.path)
            if place is None:
                yield f"budget {self._budget} has no record of this name"
                return
            stored = record.spec.model_dump(mode="json", exclude={"seed"})
            expected = (
                place.spec
                if isinstance(place, Trial)
                else campaign.run_specs(self._configuration, place)[0]
            )
            if difference := first_difference(stored, expected):
                yield f"not what budget {self._budget} has here: {difference}"
            if not set(entry.seeds) <= set(place.seeds):
                first, last = place.seeds[0], place.seeds[-1]
                yield f"holds seeds {list(entry.seeds)}, here belong {first} to {last}"

    @cached_property
    def _configuration(self) -> Configuration:
        assert self._budget is not None
        return load_configuration(self._budget)

    @cached_property
    def _blocks(self) -> dict[str, Block]:
        """What the budget has, by path below its folder."""
        return {self._below(block): block for block in campaign.blocks(self._configuration)}

    @cached_property
    def _trials(self) -> dict[str, Trial]:
        """The same for sensitivity, which takes longer to list."""
        return {
            self._below(trial): trial
            for variant in sensitivity.variants()
            for trial in sensitivity.trials(self._configuration, variant)
        }

    def _below(self, place: Block | Trial) -> str:
        return place.record.relative_to(RESULTS / self._configuration.budget.name).as_posix()


class Shelves:
    """The folders with a manifest at, above and below a path."""

    def __init__(self, path: Path) -> None:
        self._shelf = cache(Shelf)
        self._below = [each.parent for each in sorted(path.rglob(manifest.NAME))]

    def of(self, record: Path) -> Shelf | None:
        """The nearest above a record."""
        for folder in record.parents:
            if (folder / manifest.NAME).exists():
                return self._shelf(folder)
        return None

    def all(self, path: Path) -> list[Shelf]:
        """Those below a path and the nearest above it."""
        above = self.of(path)
        return [self._shelf(folder) for folder in self._below] + ([above] if above else [])
