"""The manifest: which records a budget's folder holds, so that none changes or goes unnoticed."""

import hashlib
import json
import os
from pathlib import Path, PurePosixPath
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, ValidationError
from pydantic_core import PydanticCustomError

from neol.base.errors import UserError, one_line
from neol.base.files import read_bounded, write_atomically
from neol.run.record import Record, campaign_name
from neol.run.record_file import MAX_RECORD_BYTES, parse_record, records_below
from neol.spec.configuration import ROOT, load_configuration
from neol.spec.readings import FIRST_READING
from neol.spec.types import Model, Sha256
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.jobs import Job, jobs
from neol.study.campaign.shown import chosen_tasks, select

NAME = "manifest.json"
MAX_BYTES = 2**26


def _below(path: str) -> str:
    parts = PurePosixPath(path).parts
    if not parts or parts[0] == "/" or ".." in parts:
        raise PydanticCustomError("below", "must be a path below the manifest's folder")
    return path


class ManifestEntry(Model):
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
    reading: str | None = FIRST_READING
    """That all of them are made under; left out where they are older than readings."""
    tasks: tuple[str, ...] = ()
    """Those of the budget's that it speaks for; none where it speaks for all."""
    records: tuple[ManifestEntry, ...]
    """By path."""

    @property
    def campaign(self) -> str | None:
        """Such as first/demo; None where the records are of no budget."""
        return None if self.budget is None else campaign_name(self.reading, self.budget)

    def covers(self, job: Job) -> bool:
        """Whether it speaks for the record of this job."""
        return not self.tasks or job.spec.task.name in self.tasks


def records_of(campaign: str | None) -> dict[str, Job]:
    """The records of a campaign, by path below its folder; none for one that is not known."""
    reading, _, budget = (campaign or "").rpartition("/")
    try:
        every = list(jobs(load_configuration(budget, reading=reading)))
    except UserError:  # a record may state any
        return {}
    home = RESULTS / reading / budget
    return {job.record.relative_to(home).as_posix(): job for job in every}


def write_manifest(folder: Path, tasks: str = "") -> Manifest:
    """Write the manifest of the records below a folder, atomically; same records, same bytes.

    It speaks for all tasks of the budget, or for these: "cartpole,hopper".
    Raises UserError for a record that is not whole, of another budget than the first, or none
    that these tasks have there; and for a task that the budget does not have.
    """
    governing = governing_folder(absolute(folder))
    if governing is not None:
        raise UserError(f"{folder}: {governing / NAME} speaks for it; write that one anew")
    manifest = _manifest_of(folder)
    campaign = manifest.campaign
    jobs_of_campaign = records_of(campaign)
    if manifest.budget and manifest.reading and jobs_of_campaign:
        shown = select(manifest.budget, tasks, manifest.reading)
        manifest = manifest.model_copy(update={"tasks": chosen_tasks(shown.budget)})
    elif tasks:
        raise UserError(f"{folder}: its records are of no budget that config/ has, so of no tasks")
    for entry in manifest.records if jobs_of_campaign else ():
        job = jobs_of_campaign.get(entry.path)
        if job is None:
            raise UserError(
                f"{folder / entry.path}: {campaign} has no record of this name; "
                f"a manifest is for a budget's own folder, like {RESULTS}/{campaign}"
            )
        if not manifest.covers(job):
            raise UserError(
                f"{folder / entry.path}: is of task {job.spec.task.name}, not of {tasks}; "
                "name all tasks whose records are here"
            )
    write_atomically(folder / NAME, _text(manifest).encode())
    return manifest


def governing_folder(path: Path) -> Path | None:
    """The folder whose manifest speaks for an absolute path: the outermost above it.

    A manifest speaks for all that lies beneath it, also for other manifests; so nothing that is
    added below switches it off. Nothing above the root of this checkout counts.
    """
    governing = None
    for folder in path.parents:
        if (folder / NAME).exists():
            governing = folder
        if folder == ROOT:
            break
    return governing


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


def absolute(path: Path) -> Path:
    """From the root on, so that a result does not depend on the folder one stands in."""
    return Path(os.path.abspath(path))  # noqa: PTH100  (without following links, as resolve does)


def _manifest_of(folder: Path) -> Manifest:
    """Of all records below a folder. Raises UserError for none, or some of several campaigns."""
    entries: list[ManifestEntry] = []
    firsts: dict[str | None, tuple[Path, Record]] = {}
    for path in records_below(folder):
        content = read_bounded(path, MAX_RECORD_BYTES)
        record = parse_record(path, content)
        entries.append(ManifestEntry.of(path.relative_to(folder).as_posix(), content, record))
        firsts.setdefault(record.campaign, (path, record))
    if not entries:
        raise UserError(f"{folder}: holds no records")
    if len(firsts) > 1:
        (one, (first, _)), (other, (second, _)) = list(firsts.items())[:2]
        raise UserError(f"{second}: is of {other}, {first} of {one}; give each its own folder")
    ((_, record),) = firsts.values()
    return Manifest(budget=record.budget, reading=record.reading, records=tuple(entries))


def _text(manifest: Manifest) -> str:
    """As JSON, a line a record."""
    about = manifest.model_dump(mode="json", include={"version", "budget", "reading"})
    about |= {"tasks": list(manifest.tasks)} if manifest.tasks else {}
    head = json.dumps(about)[:-1]
    entries = ",\n".join(json.dumps(entry.model_dump(mode="json")) for entry in manifest.records)
    return f'{head}, "records": [\n{entries}\n]}}\n'
