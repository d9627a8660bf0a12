"""The display of `neol status`."""

from datetime import UTC, datetime
from pathlib import Path

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from neol.cli.progress import duration
from neol.spec.run_spec import RunSpec
from neol.study.workflow.outlook import Status
from neol.study.workflow.status import JOB_STATES, Finished, JobStatus

LISTED = 5
"""Number of entries of a list that are shown."""


def picture(folder: Path, status: Status) -> RenderableType:
    """Return the whole display; a small terminal cuts the end of the table."""
    if status.done:
        return Text(f"{summary(folder, status)}: all runs are done")
    lists = {
        "Latest": [_latest(run) for run in reversed(status.finished)],
        "Running, by the last checkpoint": [_under_way(each) for each in status.of("running")],
        "Interrupted": [_under_way(each) for each in status.of("interrupted")],
        "Failed": [_failed(each) for each in status.of("failed")],
    }
    lines = [summary(folder, status), _outlook(status)]
    for title, entries in lists.items():
        if entries:
            more = [f"and {len(entries) - LISTED:,} more"] if len(entries) > LISTED else []
            lines += [f"{title}:", *(f"  {entry}" for entry in entries[:LISTED] + more)]
    return Group(Text("\n".join(lines)), "", _table(status))


def summary(folder: Path, status: Status) -> str:
    """Summarise the campaign in one line."""
    grid, study = status.states(), status.states(sensitivity=True)
    cells, all_cells = status.cells
    runs = grid + study
    parts = [
        f"{grid['done']:,} of {grid.total():,} runs done",
        f"{cells:,} of {all_cells:,} cells",
        f"{study['done']:,} of {study.total():,} of the sensitivity study",
        *(
            f"{runs[state]:,} {state}"
            for state in ("running", "interrupted", "failed")
            if runs[state]
        ),
    ]
    if status.seconds_left is not None:
        parts.append(f"{duration(status.seconds_left)} left")
    return f"{folder}: {', '.join(parts)}"


def _table(status: Status) -> RenderableType:
    table = Table(box=None, pad_edge=False)
    for name in ("task", "method"):
        table.add_column(name, no_wrap=True)
    for name in ("runs", *JOB_STATES, "core-hours left"):
        table.add_column(name, justify="right")
    for row in status.rows:
        hours = "unknown" if row.core_hours is None else f"{row.core_hours:,.2f}"
        counts = [str(row.states[state] or "-") for state in JOB_STATES]
        table.add_row(row.task, row.part, str(row.states.total()), *counts, hours)
    return table


def _outlook(status: Status) -> str:
    """Describe the estimated cost of the rest."""
    rows = [row for row in status.rows if row.states["done"] < row.states.total()]
    hours = sum(row.core_hours or 0.0 for row in rows)
    unknown = dict.fromkeys(row.task for row in rows if row.core_hours is None)
    parts = [f"about {hours:,.2f} core-hours are left"] if hours else []
    if unknown:
        parts.append(f"the cost of {', '.join(unknown)} was never measured")
    if not status.of("running"):
        parts.append("no run is in progress")
    elif status.seconds_left is not None:
        parts.append(f"{duration(status.seconds_left)} with one core for each running job")
    sentence = "; ".join(parts)
    return f"{sentence[0].upper()}{sentence[1:]}."


def _name(spec: RunSpec, seed: int) -> str:
    plasticity = spec.plasticity
    eta = f" eta={plasticity.learning_rate:g}" if plasticity.learns else ""
    return f"{spec.task.name} {spec.method} P={spec.population}{eta} seed {seed}"


def _latest(run: Finished) -> str:
    held_out = "" if run.held_out is None else f", held-out mean {run.held_out:.1f}"
    ago = age((datetime.now(UTC) - run.time).total_seconds())
    return f"{_name(run.spec, run.spec.seed)}: best {run.best_fitness:.1f}{held_out}, {ago} ago"


def age(seconds: float) -> str:
    """Format an age in its largest unit: 6 days, 1 hour, 0 seconds."""
    units = {"day": 86400, "hour": 3600, "minute": 60, "second": 1}
    unit = next((name for name, length in units.items() if seconds >= length), "second")
    count = max(0, int(seconds // units[unit]))
    return f"{count} {unit}{'s' * (count != 1)}"


def _under_way(status: JobStatus) -> str:
    spec = status.job.spec
    name = _name(spec, status.seed)
    return f"{name}: generation {status.generation} of {spec.generations}"


def _failed(status: JobStatus) -> str:
    log = f" ({status.job.log})" if status.job.log.exists() else ""
    return f"{_name(status.job.spec, status.seed)}: {status.reason}{log}"
