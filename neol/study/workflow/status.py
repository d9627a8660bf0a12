"""Status of a budget's campaign, read from its folder without changing it.

The runs of a record are made one after another. Finished runs are in the record or, before it is
complete, in its `.partial` folder; the next run is running, interrupted, failed or missing, and
those after it are missing.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Literal, get_args

from neol.base.errors import INTERRUPTED, NOTICE, TERMINATED, UserError
from neol.run import checkpoint
from neol.run.record_file import read_footer
from neol.run.workspace import checkpoint_path, finished_path, is_running, partial_folder
from neol.spec.configuration import Configuration
from neol.spec.run_spec import RunSpec
from neol.study.campaign.jobs import Job, jobs

JobState = Literal["done", "running", "interrupted", "failed", "missing"]
JOB_STATES: tuple[JobState, ...] = get_args(JobState)

LOG_BYTES = 2**16
"""Bytes that are read from the end of a log."""
NO_FAILURE = (NOTICE, f"neol: {INTERRUPTED}", f"neol: {TERMINATED}", "KeyboardInterrupt")
"""Beginnings of the last line of a log that does not end in an error."""


@dataclass(frozen=True, slots=True)
class Finished:
    """Results of a finished run."""

    spec: RunSpec
    """Specification with the run's seed."""
    best_fitness: float
    held_out: float | None
    """Mean return of the champion in held-out episodes; None if all of them failed."""
    cpu_seconds: float
    time: datetime


@dataclass(frozen=True, slots=True)
class JobStatus:
    """Status of a job."""

    job: Job
    state: JobState
    """State of the first unfinished run; "done" if there is none."""
    finished: tuple[Finished, ...] = ()
    generation: int = 0
    """Generations in the last checkpoint of that run."""
    reason: str = ""
    """Reason of a failure."""

    @property
    def runs_left(self) -> float:
        """Number of unfinished runs; a run in progress counts by its missing generations."""
        return len(self._unfinished) - self.generation / self.job.spec.generations

    @property
    def seed(self) -> int:
        """Seed of the first unfinished run."""
        return self._unfinished[0]

    @property
    def states(self) -> Counter[JobState]:
        """Number of runs in each state."""
        counts = Counter[JobState]({"done": len(self.finished)})
        if self._unfinished:
            counts[self.state] += 1
            counts["missing"] += len(self._unfinished) - 1
        return counts

    @property
    def _unfinished(self) -> list[int]:
        return _unfinished(self.job, self.finished)


class Folder:
    """A budget's folder; it reads each record again only after a change."""

    def __init__(self, path: Path, configuration: Configuration) -> None:
        self.path = path
        self._jobs = list(jobs(configuration, path.parent.parent))
        self._read: dict[Path, tuple[tuple[int, int], tuple[Finished, ...]]] = {}

    def job_statuses(self) -> list[JobStatus]:
        """Return the current status of each job."""
        return [self._job_status(job) for job in self._jobs]

    def _job_status(self, job: Job) -> JobStatus:
        status = self._status(job)
        if status.state in ("interrupted", "missing") and (reason := _failure(job.log)):
            return replace(status, state="failed", reason=reason)
        return status

    def _status(self, job: Job, looks: int = 3) -> JobStatus:
        workspace = partial_folder(job.record)
        try:
            if job.record.exists():
                finished = self._runs(job)
                return JobStatus(job, "done" if finished else "missing", finished)
            if not workspace.exists():
                return JobStatus(job, "missing")
            singles = [
                replace(job, record=finished_path(workspace, seed), seeds=range(seed, seed + 1))
                for seed in job.seeds
            ]
            finished = tuple(r for one in singles if one.record.exists() for r in self._runs(one))
        except FileNotFoundError as error:  # finished meanwhile: its runs have moved to its record
            if looks == 1:
                return JobStatus(job, "failed", reason=f"{error.filename}: appears and disappears")
            return self._status(job, looks - 1)
        except UserError as error:
            return JobStatus(job, "failed", reason=str(error))
        if not (unfinished := _unfinished(job, finished)):
            return JobStatus(job, "done", finished)
        generation = checkpoint.generations_done(checkpoint_path(workspace, unfinished[0]))
        state: JobState = "running" if is_running(workspace) else "interrupted"
        return JobStatus(job, state, finished, generation)

    def _runs(self, job: Job) -> tuple[Finished, ...]:
        """Return the runs of a job's record; none if the workflow will make it again.

        Raises UserError if the record cannot be used.
        """
        path = job.record
        stat = path.stat()
        version = stat.st_mtime_ns, stat.st_size
        if path not in self._read or self._read[path][0] != version:
            footer = read_footer(path)
            infos = () if job.misfit(footer) else footer.seeds
            runs = tuple(
                Finished(
                    spec=job.spec.model_copy(update={"seed": info.seed}),
                    best_fitness=info.champion.fitness,
                    held_out=info.held_out.mean,
                    cpu_seconds=info.cpu_seconds,
                    time=_time(path, info.provenance.time),
                )
                for info in infos
            )
            self._read[path] = version, runs
        return self._read[path][1]


def _time(path: Path, text: str) -> datetime:
    """Parse a time. Raises UserError for text that is not a time with its zone."""
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        time = datetime.min
    if time.tzinfo is None:
        raise UserError(f"{path}: {text[:50]!r} is not a time in UTC; restore it, or run again")
    return time


def _unfinished(job: Job, finished: Iterable[Finished]) -> list[int]:
    done = {run.spec.seed for run in finished}
    return [seed for seed in job.seeds if seed not in done]


def _failure(log: Path) -> str:
    """Return the last line of a log that ends in an error, otherwise nothing."""
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - LOG_BYTES))
            lines = file.read(LOG_BYTES).decode(errors="replace").split("\n")
    except OSError:
        return ""
    last = next((line.strip() for line in reversed(lines) if line.strip()), "")
    is_error = last.startswith("neol: ") or "Traceback (most recent call last):" in lines
    return last if is_error and not last.startswith(NO_FAILURE) else ""
