"""What a campaign's rest will cost, and how its runs stand in all.

A cost is estimated from the runs that are done and most alike.
"""

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from neol.spec.run_spec import RunSpec
from neol.study.campaign.cost import run_seconds
from neol.study.campaign.jobs import SENSITIVITY
from neol.study.campaign.status import JobState, JobStatus

RECENT_RUNS = 20
"""As many of the latest runs say how fast runs finish at present."""
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
    states: Counter[JobState]
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

    def of(self, state: JobState) -> list[JobStatus]:
        """The jobs whose next run is in a state."""
        return [status for status in self.statuses if status.state == state]

    def states(self, *, sensitivity: bool = False) -> Counter[JobState]:
        """How many runs are in each state: those of the grid, or those of the sensitivity study."""
        counts = Counter[JobState]()
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
        states = sum((status.states for status in group), Counter[JobState]())
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
