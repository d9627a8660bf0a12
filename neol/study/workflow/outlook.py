"""Summary of a campaign's status, and the estimated cost of the rest."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from neol.study.campaign.cost import run_seconds
from neol.study.campaign.jobs import SENSITIVITY
from neol.study.workflow.status import Finished, JobState, JobStatus


@dataclass(frozen=True, slots=True)
class Row:
    """A part of the campaign on one task."""

    task: str
    part: str
    states: Counter[JobState]
    core_hours: float | None
    """Estimated cost of the rest; None for a task that was never measured."""


class Status:
    """Status of a campaign."""

    def __init__(self, statuses: Sequence[JobStatus]) -> None:
        self.statuses = statuses
        self.finished = sorted(
            (run for status in statuses for run in status.finished), key=lambda run: run.time
        )

    def of(self, state: JobState) -> list[JobStatus]:
        """Return the jobs whose next run is in a state."""
        return [status for status in self.statuses if status.state == state]

    def states(self, *, sensitivity: bool = False) -> Counter[JobState]:
        """Count the runs in each state: those of the grid, or those of the sensitivity study."""
        counts = Counter[JobState]()
        for status in self.statuses:
            if (status.job.part == SENSITIVITY) == sensitivity:
                counts += status.states
        return counts

    @property
    def done(self) -> bool:
        """Whether all runs are done, those of the sensitivity study too."""
        return all(status.state == "done" for status in self.statuses)

    @property
    def over(self) -> bool:
        """Whether the grid is done and no run is in progress."""
        runs = self.states()
        return runs["done"] == runs.total() and not self.of("running")

    @property
    def cells(self) -> tuple[int, int]:
        """Numbers of finished cells of the grid and of all cells."""
        cells: dict[Path, bool] = {}
        for status in self.statuses:
            if status.job.part != SENSITIVITY:
                cell = status.job.record.parent
                cells[cell] = cells.get(cell, True) and status.state == "done"
        return sum(cells.values()), len(cells)

    @cached_property
    def rows(self) -> list[Row]:
        """Rows of the table: tasks and methods in the budget's order, sensitivity study last."""
        groups: dict[tuple[str, str], list[JobStatus]] = {}
        for status in self.statuses:
            groups.setdefault((status.job.spec.task.name, status.job.part), []).append(status)
        paces = _paces(self.finished)
        return [_row(*place, group, paces.get(place[0], 1.0)) for place, group in groups.items()]

    @property
    def seconds_left(self) -> float | None:
        """Time to the end with one core for each running job; None if none runs or unknown."""
        hours = [row.core_hours for row in self.rows]
        running = len(self.of("running"))
        if None in hours or not running:
            return None
        return 3600.0 * sum(filter(None, hours)) / running


def _paces(finished: Iterable[Finished]) -> dict[str, float]:
    """Return each task's CPU time as a multiple of what measurements predict for its runs."""
    spent, predicted = defaultdict[str, float](float), defaultdict[str, float](float)
    for run in finished:
        task = run.spec.task.name
        spent[task] += run.cpu_seconds
        predicted[task] += run_seconds(run.spec) or 0.0
    return {task: spent[task] / seconds for task, seconds in predicted.items() if seconds}


def _row(task: str, part: str, group: Sequence[JobStatus], pace: float) -> Row:
    """Return a row; the rest costs what measurements predict, at the pace of finished runs."""
    states = sum((status.states for status in group), Counter[JobState]())
    rest = [
        (status.runs_left, run_seconds(status.job.spec)) for status in group if status.runs_left
    ]
    seconds = [None if each is None else runs * each * pace for runs, each in rest]
    hours = None if None in seconds else sum(filter(None, seconds)) / 3600.0
    return Row(task, part, states, hours)
