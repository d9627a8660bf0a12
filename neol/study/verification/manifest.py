"""The manifest: the list of a folder's records, so that changed or lost ones are noticed."""

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
    """Entry of one record."""

    path: Annotated[str, AfterValidator(_below)]
    """Path below the manifest's folder, with slashes."""
    sha256: Sha256
    """SHA-256 of the file."""
    spec_digest: Sha256
    """Digest of the specification without the seed."""
    seeds: tuple[int, ...]
    commits: tuple[str, ...]
    """Commits that made its runs, sorted; with -dirty if code or constants differed."""

    @classmethod
    def of(cls, path: str, content: bytes, record: Record) -> Self:
        """Return the entry of a record that was read from this content."""
        parts = (each for info in record.seeds for each in info.provenance.each())
        return cls(
            path=path,
            sha256=hashlib.sha256(content).hexdigest(),
            spec_digest=record.spec.digest(),
            seeds=tuple(info.seed for info in record.seeds),
            commits=tuple(sorted({each.code() for each in parts})),
        )


class Manifest(Model):
    """The records below a folder."""

    version: Literal[1] = 1
    budget: str | None
    """Budget of all records."""
    reading: str | None = FIRST_READING
    """Reading of all records; omitted if they are older than readings."""
    tasks: tuple[str, ...] = ()
    """Tasks that the manifest covers; empty if it covers all of the budget."""
    records: tuple[ManifestEntry, ...]
    """Entries sorted by path."""

    @property
    def campaign(self) -> str | None:
        """Campaign such as rare_mutation/demo; None without budget or reading."""
        if self.budget is None or self.reading is None:
            return None
        return campaign_name(self.reading, self.budget)

    def covers(self, job: Job) -> bool:
        """Whether the manifest covers the record of this job."""
        return not self.tasks or job.spec.task.name in self.tasks


def records_of(campaign: str | None) -> dict[str, Job]:
    """Return the records of a campaign by path below its folder; none if it is unknown.

    Those that another budget keeps are not among them.
    """
    reading, _, budget = (campaign or "").rpartition("/")
    try:
        every = list(jobs(load_configuration(budget, reading=reading)))
    except UserError:  # a record may state any campaign
        return {}
    home = RESULTS / reading / budget
    own = (job for job in every if job.record.is_relative_to(home))
    return {job.record.relative_to(home).as_posix(): job for job in own}


def write_manifest(folder: Path, tasks: str = "") -> Manifest:
    """Write the manifest of the records below a folder, atomically; same records, same bytes.

    It covers all tasks of the budget, or the named ones: "cartpole,hopper". Raises UserError for a
    damaged record, one of another budget than the first, one that these tasks do not have there,
    and for a task that the budget does not have.
    """
    governing = governing_folder(absolute(folder))
    if governing is not None:
        raise UserError(f"{folder}: {governing / NAME} covers it; write that one again")
    manifest = _manifest_of(folder)
    campaign = manifest.campaign
    jobs_of_campaign = records_of(campaign)
    if manifest.budget and manifest.reading and jobs_of_campaign:
        shown = select(manifest.budget, tasks, manifest.reading)
        manifest = manifest.model_copy(update={"tasks": chosen_tasks(shown.budget)})
    elif tasks:
        raise UserError(f"{folder}: its records are of no budget in config/, so it has no tasks")
    for entry in manifest.records if jobs_of_campaign else ():
        job = jobs_of_campaign.get(entry.path)
        if job is None:
            raise UserError(
                f"{folder / entry.path}: {campaign} has no record of this name; "
                f"write the manifest of a budget's folder, like {RESULTS}/{campaign}"
            )
        if not manifest.covers(job):
            raise UserError(
                f"{folder / entry.path}: is of task {job.spec.task.name}, not of {tasks}; "
                "name all tasks whose records are here"
            )
    write_atomically(folder / NAME, _text(manifest).encode())
    return manifest


def governing_folder(path: Path) -> Path | None:
    """Return the folder whose manifest covers an absolute path: the outermost one above it.

    A manifest covers everything below it, also other manifests, so no added file can disable it.
    Folders above the root of this checkout do not count.
    """
    governing = None
    for folder in path.parents:
        if (folder / NAME).exists():
            governing = folder
        if folder == ROOT:
            break
    return governing


def read_manifest(folder: Path) -> Manifest:
    """Read the manifest of a folder. Raises UserError if it is missing or damaged."""
    path = folder / NAME
    way_out = f"restore it, or write it again by neol manifest {folder}"
    try:
        manifest = Manifest.model_validate_json(read_bounded(path, MAX_BYTES))
    except ValidationError as error:
        raise UserError(f"{path}: damaged: {one_line(error, Manifest)}; {way_out}") from None
    paths = [entry.path for entry in manifest.records]
    if paths != sorted(set(paths)):
        raise UserError(f"{path}: damaged: not sorted, or a record twice; {way_out}")
    return manifest


def absolute(path: Path) -> Path:
    """Return the absolute path, so that a result does not depend on the working folder."""
    return Path(os.path.abspath(path))  # noqa: PTH100  (without following links, as resolve does)


def _manifest_of(folder: Path) -> Manifest:
    """Return the manifest of all records below a folder.

    Raises UserError if there are none, or if they belong to several campaigns.
    """
    entries: list[ManifestEntry] = []
    firsts: dict[str | None, tuple[Path, Record]] = {}
    for path in records_below(folder):
        content = read_bounded(path, MAX_RECORD_BYTES)
        record = parse_record(path, content)
        entries.append(ManifestEntry.of(path.relative_to(folder).as_posix(), content, record))
        firsts.setdefault(record.campaign, (path, record))
    if not entries:
        raise UserError(f"{folder}: contains no records")
    if len(firsts) > 1:
        (one, (first, _)), (other, (second, _)) = list(firsts.items())[:2]
        raise UserError(f"{second}: is of {other}, {first} of {one}; give each its own folder")
    ((_, record),) = firsts.values()
    return Manifest(budget=record.budget, reading=record.reading, records=tuple(entries))


def _text(manifest: Manifest) -> str:
    """Return the manifest as JSON with one line for each record."""
    about = manifest.model_dump(mode="json", include={"version", "budget", "reading"})
    about |= {"tasks": list(manifest.tasks)} if manifest.tasks else {}
    head = json.dumps(about)[:-1]
    entries = ",\n".join(json.dumps(entry.model_dump(mode="json")) for entry in manifest.records)
    return f'{head}, "records": [\n{entries}\n]}}\n'
