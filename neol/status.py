"""How far a budget's campaign is, read from its folder and without touching it.

The runs of a record are made one after another. Those that are done are in the record or, while it
is under way, in its `.partial` folder; the next one is running, interrupted, failed or missing,
and those after it are missing.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Literal, get_args

from neol import checkpoint
from neol.cost import run_seconds
from neol.errors import INTERRUPTED, NOTICE, TERMINATED, UserError
from neol.jobs import SENSITIVITY, Job, jobs
from neol.partial import checkpoint_path, finished_path, is_running, partial_folder
from neol.records import read_footer
from neol.spec import Configuration, RunSpec

State = Literal["done", "running", "interrupted", "failed", "missing"]
STATES: tuple[State, ...] = get_args(State)

RECENT_RUNS = 20
"""As many of the latest runs say how fast runs finish at present."""
LOG_BYTES = 2**16
"""As much of a log's end is read."""
NO_FAILURE = (NOTICE, f"neol: {INTERRUPTED}", f"neol: {TERMINATED}", "KeyboardInterrupt")
"""How the last line of a log begins that ends in no error."""


@dataclass(frozen=True, slots=True)
class Finished:
    """What a finished run came to."""

    spec: RunSpec
    """With its seed."""
    best_fitness: float
    held_out: float | None
    """Mean return of the champion in fresh episodes; None if all of them failed."""
    cpu_seconds: float
    wall_seconds: float
    time: datetime


@dataclass(frozen=True, slots=True)
class JobStatus:
    """How far a job is."""

    job: Job
    state: State
    """Of the first run that is not done; "done" where all are."""
    finished: tuple[Finished, ...] = ()
    generation: int = 0
    """How many generations of that run its last checkpoint holds."""
    reason: str = ""
    """Why it failed."""

    @property
    def runs_left(self) -> float:
        """How many runs are still to make; a run under way counts by its generations."""
        return len(self._unfinished) - self.generation / self.job.spec.generations

    @property
    def seed(self) -> int:
        """That of the first run that is not done."""
        return self._unfinished[0]

    @property
    def states(self) -> Counter[State]:
        """How many of the runs are in each state."""
        counts = Counter[State]({"done": len(self.finished)})
        if self._unfinished:
            counts[self.state] += 1
            counts["missing"] += len(self._unfinished) - 1
        return counts

    @property
    def _unfinished(self) -> list[int]:
        return _unfinished(self.job, self.finished)


class Folder:
    """A budget's folder. What a look has read of a record, the next one does not read again."""

    def __init__(self, path: Path, configuration: Configuration) -> None:
        self.path = path
        self._jobs = list(jobs(configuration, path.parent))
        self._read: dict[Path, tuple[tuple[int, int], tuple[Finished, ...]]] = {}

    def look(self) -> list[JobStatus]:
        """How far each job is now."""
        return [self._look(job) for job in self._jobs]

    def _look(self, job: Job) -> JobStatus:
        status = self._status(job)
        if status.state in ("interrupted", "missing") and (reason := _failure(job.log)):
            return replace(status, state="failed", reason=reason)
        return status

    def _status(self, job: Job, looks: int = 3) -> JobStatus:
        partial = partial_folder(job.record)
        try:
            if job.record.exists():
                finished = self._runs(job)
                return JobStatus(job, "done" if finished else "missing", finished)
            if not partial.exists():
                return JobStatus(job, "missing")
            singles = [
                replace(job, record=finished_path(partial, seed), seeds=range(seed, seed + 1))
                for seed in job.seeds
            ]
            finished = tuple(r for one in singles if one.record.exists() for r in self._runs(one))
        except FileNotFoundError as error:  # done since: its runs have moved to its record
            if looks == 1:
                return JobStatus(job, "failed", reason=f"{error.filename}: comes and goes")
            return self._status(job, looks - 1)
        except UserError as error:
            return JobStatus(job, "failed", reason=str(error))
        if not (unfinished := _unfinished(job, finished)):
            return JobStatus(job, "done", finished)
        generation = checkpoint.generations(checkpoint_path(partial, unfinished[0]))
        state: State = "running" if is_running(partial) else "interrupted"
        return JobStatus(job, state, finished, generation)

    def _runs(self, job: Job) -> tuple[Finished, ...]:
        """The runs of a job's record; none where the workflow will make it anew.

        Raises UserError where it cannot be used.
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
                    wall_seconds=info.wall_seconds,
                    time=_time(path, info.provenance.time),
                )
                for info in infos
            )
            self._read[path] = version, runs
        return self._read[path][1]


def _time(path: Path, text: str) -> datetime:
    """Raises UserError for what is no time with its zone."""
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        time = datetime.min
    if time.tzinfo is None:
        raise UserError(f"{path}: {text[:50]!r} is no time in UTC; restore it, or run anew")
    return time


def _unfinished(job: Job, finished: Iterable[Finished]) -> list[int]:
    done = {run.spec.seed for run in finished}
    return [seed for seed in job.seeds if seed not in done]


def _failure(log: Path) -> str:
    """The last line of a log that ends in an error; nothing of any other."""
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - LOG_BYTES))
            lines = file.read(LOG_BYTES).decode(errors="replace").split("\n")
    except OSError:
        return ""
    last = next((line.strip() for line in reversed(lines) if line.strip()), "")
    is_error = last.startswith("neol: ") or "Traceback (most recent call last):" in lines
    return last if is_error and not last.startswith(NO_FAILURE) else ""


# --- What it comes to ---------------------------------------------------------------------------

BASES = (
    "its own runs",
    "runs of other populations",
    "runs of other methods",
    "the shipped measurements",
)
"""What a cost is estimated from, the best first."""


@dataclass(frozen=True, slots=True)
class Row:
    """A part of the campaign on a task."""

    task: str
    part: str
    states: Counter[State]
    core_hours: float | None
    """What the rest will cost; None where the task was never measured."""
    basis: str
    """One of `BASES`, the worst that was needed; empty where nothing is left or measured."""


class Status:
    """Where a campaign stands."""

    def __init__(self, statuses: Sequence[JobStatus]) -> None:
        self.statuses = statuses
        self.finished = sorted(
            (run for status in statuses for run in status.finished), key=lambda run: run.time
        )
        self._seconds: defaultdict[tuple[object, ...], float] = defaultdict(float)
        self._episodes: Counter[tuple[object, ...]] = Counter()
        for run in self.finished:
            for key in _alike(run.spec):
                self._seconds[key] += run.cpu_seconds
                self._episodes[key] += _episodes(run.spec)

    def of(self, state: State) -> list[JobStatus]:
        """The jobs whose next run is in a state."""
        return [status for status in self.statuses if status.state == state]

    def states(self, *, sensitivity: bool = False) -> Counter[State]:
        """How many runs are in each state: those of the grid, or those of the sensitivity study."""
        counts = Counter[State]()
        for status in self.statuses:
            if (status.job.part == SENSITIVITY) == sensitivity:
                counts += status.states
        return counts

    @property
    def over(self) -> bool:
        """Whether the grid is done and nothing is running."""
        runs = self.states()
        return runs["done"] == runs.total() and not self.of("running")

    @property
    def cells(self) -> tuple[int, int]:
        """How many cells of the grid are done, and how many there are."""
        cells: dict[Path, bool] = {}
        for status in self.statuses:
            if status.job.part != SENSITIVITY:
                cell = status.job.record.parent
                cells[cell] = cells.get(cell, True) and status.state == "done"
        return sum(cells.values()), len(cells)

    @cached_property
    def rows(self) -> list[Row]:
        """The table: tasks and methods in the order of the budget, its sensitivity study last."""
        groups: dict[tuple[str, str], list[JobStatus]] = {}
        for status in self.statuses:
            groups.setdefault((status.job.spec.task.name, status.job.part), []).append(status)
        return [self._row(task, part, group) for (task, part), group in groups.items()]

    @property
    def seconds_left(self) -> float | None:
        """Until all is done at the present rate; None where nothing runs or a cost is unknown."""
        hours = [row.core_hours for row in self.rows]
        recent = self.finished[-RECENT_RUNS:]
        wall = sum(run.wall_seconds for run in recent)
        cores = len(self.of("running")) * sum(run.cpu_seconds for run in recent) / (wall or 1.0)
        if None in hours or cores == 0.0:
            return None
        return 3600.0 * sum(filter(None, hours)) / cores

    def _row(self, task: str, part: str, group: Sequence[JobStatus]) -> Row:
        states = sum((status.states for status in group), Counter[State]())
        seconds, worst = 0.0, -1
        for status in group:
            if status.runs_left:
                cost, basis = self._cost(status.job.spec)
                seconds += status.runs_left * cost
                worst = max(worst, basis)
        known = worst < len(BASES)
        return Row(
            task=task,
            part=part,
            states=states,
            core_hours=seconds / 3600.0 if known else None,
            basis=BASES[worst] if known and worst >= 0 else "",
        )

    def _cost(self, spec: RunSpec) -> tuple[float, int]:
        """CPU seconds of a run, and the place of what they are taken from among `BASES`."""
        for place, key in enumerate(_alike(spec)):
            if self._episodes[key]:
                return _episodes(spec) * self._seconds[key] / self._episodes[key], place
        measured = run_seconds(spec)
        return (0.0, len(BASES)) if measured is None else (measured, len(BASES) - 1)


def _alike(spec: RunSpec) -> list[tuple[object, ...]]:
    """The groups of runs that a run's cost may be taken from, the nearest first."""
    return [
        (spec.task.name, spec.method, spec.population),
        (spec.task.name, spec.method),
        (spec.task.name,),
    ]


def _episodes(spec: RunSpec) -> int:
    """How many episodes a run trains in."""
    return spec.population * spec.generations * spec.evaluation.episodes
