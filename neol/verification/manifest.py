"""The manifest: which records a budget's folder holds, so that none changes or goes unnoticed."""

import hashlib
import json
from pathlib import Path, PurePosixPath
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, ValidationError
from pydantic_core import PydanticCustomError

from neol.campaign import RESULTS
from neol.complaint import one_line
from neol.errors import UserError
from neol.files import read_bounded, write_atomically
from neol.jobs import Job, jobs
from neol.model import Model
from neol.record import Record
from neol.records import MAX_BYTES as MAX_RECORD_BYTES
from neol.records import parse_record, records_below
from neol.selection import chosen_tasks, select
from neol.spec import budgets, load_configuration

NAME = "manifest.json"
MAX_BYTES = 2**26


def _below(path: str) -> str:
    parts = PurePosixPath(path).parts
    if not parts or parts[0] == "/" or ".." in parts:
        raise PydanticCustomError("below", "must be a path below the manifest's folder")
    return path


Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Entry(Model):
    """What the manifest says of one record."""

    path: Annotated[str, AfterValidator(_below)]
    """From the manifest's folder on, with slashes."""
    sha256: Sha256
    """Of the file."""
    spec_digest: Sha256
    """Of the specification without the seed."""
    seeds: tuple[int, ...]
    commits: tuple[str, ...]
    """Those that made its runs, sorted; with -dirty where code or constants differed."""

    @classmethod
    def of(cls, path: str, content: bytes, record: Record) -> Self:
        """The entry of a record, read from this content."""
        return cls(
            path=path,
            sha256=hashlib.sha256(content).hexdigest(),
            spec_digest=record.spec.digest(),
            seeds=tuple(info.seed for info in record.seeds),
            commits=tuple(sorted({info.provenance.code() for info in record.seeds})),
        )


class Manifest(Model):
    """The records below a folder."""

    version: Literal[1] = 1
    budget: str | None
    """That all of them belong to."""
    tasks: tuple[str, ...] = ()
    """Those of the budget's that it speaks for; none where it speaks for all."""
    records: tuple[Entry, ...]
    """By path."""

    def covers(self, job: Job) -> bool:
        """Whether it speaks for the record of this job."""
        return not self.tasks or job.spec.task.name in self.tasks


def records_of(budget: str | None) -> dict[str, Job]:
    """The records of a budget, by path below its folder; none for one that is not known."""
    if budget is None or budget not in budgets():
        return {}
    home = RESULTS / budget
    every = jobs(load_configuration(budget))
    return {job.record.relative_to(home).as_posix(): job for job in every}


def write_manifest(folder: Path, tasks: str = "") -> Manifest:
    """Write the manifest of the records below a folder, atomically; same records, same bytes.

    It speaks for all tasks of the budget, or for these: "cartpole,hopper".
    Raises UserError for a record that is not whole, of another budget than the first, or none
    that these tasks have there; and for a task that the budget does not have.
    """
    budget, entries = _entries(folder)
    jobs_of_budget = records_of(budget)
    chosen: tuple[str, ...] = ()
    if budget and jobs_of_budget:
        chosen = chosen_tasks(select(budget, tasks).budget)
    elif tasks:
        raise UserError(f"{folder}: its records are of no budget that config/ has, so of no tasks")
    manifest = Manifest(budget=budget, tasks=chosen, records=entries)
    for entry in entries if jobs_of_budget else ():
        job = jobs_of_budget.get(entry.path)
        if job is None:
            raise UserError(
                f"{folder / entry.path}: budget {budget} has no record of this name; "
                f"a manifest is for a budget's own folder, like {RESULTS}/{budget}"
            )
        if not manifest.covers(job):
            raise UserError(
                f"{folder / entry.path}: is of task {job.spec.task.name}, not of {tasks}; "
                "name all tasks whose records are here"
            )
    write_atomically(folder / NAME, _text(manifest).encode())
    return manifest


def read_manifest(folder: Path) -> Manifest:
    """The manifest of a folder. Raises UserError where there is none or it is damaged."""
    path = folder / NAME
    way_out = f"restore it, or write it anew by neol manifest {folder}"
    try:
        manifest = Manifest.model_validate_json(read_bounded(path, MAX_BYTES))
    except ValidationError as error:
        raise UserError(f"{path}: damaged: {one_line(error, Manifest)}; {way_out}") from None
    paths = [entry.path for entry in manifest.records]
    if paths != sorted(set(paths)):
        raise UserError(f"{path}: damaged: not sorted, or a record twice; {way_out}")
    return manifest


def _entries(folder: Path) -> tuple[str | None, tuple[Entry, ...]]:
    """The budget of the records below a folder, and their entries. Raises UserError for several."""
    entries: list[Entry] = []
    firsts: dict[str | None, Path] = {}
    for path in records_below(folder):
        content = read_bounded(path, MAX_RECORD_BYTES)
        record = parse_record(path, content)
        entries.append(Entry.of(path.relative_to(folder).as_posix(), content, record))
        firsts.setdefault(record.budget, path)
    if not entries:
        raise UserError(f"{folder}: holds no records")
    if len(firsts) > 1:
        (one, first), (other, second) = list(firsts.items())[:2]
        raise UserError(
            f"{second}: is of budget {other}, {first} of {one}; give each budget its own folder"
        )
    (budget,) = firsts
    return budget, tuple(entries)


def _text(manifest: Manifest) -> str:
    """As JSON, a line a record."""
    about = manifest.model_dump(mode="json", include={"version", "budget"})
    about |= {"tasks": list(manifest.tasks)} if manifest.tasks else {}
    head = json.dumps(about)[:-1]
    entries = ",\n".join(json.dumps(entry.model_dump(mode="json")) for entry in manifest.records)
    return f'{head}, "records": [\n{entries}\n]}}\n'
