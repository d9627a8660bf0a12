"""The numbers of docs/scaling.md.

`python -m benchmarks.scaling desk` prints those of a budget, with those of its records.
"""

import heapq
import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from benchmarks.table import TITLES, Table, markdown, number
from neol.base.errors import UserError
from neol.pictures.labels import method_label
from neol.run.record_file import read_record
from neol.spec.configuration import ROOT, load_configuration
from neol.study.campaign.cost import Get, neat_seconds, recorded_lengths, run_seconds, shipped
from neol.study.campaign.jobs import SENSITIVITY, Job, jobs
from neol.study.campaign.reference import settings
from neol.study.campaign.shown import DEFAULT_BUDGET, select

BEGIN, END = "<!-- generated: begin -->", "<!-- generated: end -->"
CORES = (1, 8, 64, 512)
HOUR = 3600


def scaling(table: Table, about: Mapping[str, str]) -> str:
    """Describe the measurements, the paper's cost, and the default budget's beside its records."""
    where = f"{about['CPU']}, {about['Date']} ({about['Run']})"
    parts = [f"On {where}:\n", _measured(table), prediction(table.get, "paper")]
    return "\n".join(parts) + "\n" + comparison(table.get, DEFAULT_BUDGET)


def prediction(get: Get, budget: str) -> str:
    """Describe the cost of a budget: by task, by run, and in days."""
    costs = _costs(get, budget)
    return f"{_core_hours(costs)}\n{_runs(costs)}\n{_wall(costs)}"


def comparison(get: Get, budget: str) -> str:
    """Compare the predicted cost of a budget's existing records with their measured cost."""
    parts = []
    for cost in _costs(get, budget):
        path, spec = ROOT / cost.job.record, cost.job.spec
        if path.exists():
            spent = sum(info.cpu_seconds for info in read_record(path, spec).seeds)
            parts.append((spec.task.name, (cost.runs, cost.seconds, spent)))
    rows = [
        [task, f"{runs:,.0f}", *map(number, (predicted / 60, spent / 60, spent / predicted))]
        for task, (runs, predicted, spent) in _sums(parts)
    ]
    header = (f"core-minutes of `{budget}`", "runs", "predicted", "in its records", "ratio")
    return markdown(header, rows)


def spent(budget: str) -> str:
    """Return the measured cost of a budget's records, and that of its sensitivity study."""
    parts = []
    for job in jobs(select(budget)):
        if (ROOT / job.record).exists():
            record = read_record(ROOT / job.record, job.spec)
            steps = sum(record.rows_of(seed)["env_steps"][-1] for seed in job.seeds)
            took = (len(job.seeds), steps, sum(info.cpu_seconds for info in record.seeds))
            none = (0, 0, 0.0)
            of_each = (*none, *took) if job.part == SENSITIVITY else (*took, *none)
            parts.append((job.spec.task.name, of_each))
    rows = [
        [
            task,
            *(
                text
                for runs, steps, seconds in (values[:3], values[3:])
                for text in (f"{runs:,.0f}", f"{steps / 1e6:,.0f}", f"{seconds / HOUR:.2f}")
            ),
        ]
        for task, values in _sums(parts)
    ]
    header = [f"`{budget}`, from its records", "runs of the grid", "million steps", "core-hours"]
    header += ["runs of the sensitivity study", "million steps", "core-hours"]
    return markdown(header, rows)


@dataclass(frozen=True)
class Cost:
    """Core-seconds of all runs of a job."""

    job: Job
    seconds: float
    longest: float
    """Core-seconds if every episode lasts to the task's limit."""

    @property
    def runs(self) -> int:
        return len(self.job.seeds)


def _costs(get: Get, budget: str) -> list[Cost]:
    """Return the costs of a budget's grid, for its measured tasks."""
    found = []
    for job in jobs(select(budget)):
        usual, longest = run_seconds(job.spec, get), run_seconds(job.spec, get, to_the_limit=True)
        if job.part != SENSITIVITY and usual is not None and longest is not None:
            found.append(Cost(job, len(job.seeds) * usual, len(job.seeds) * longest))
    return found


def _sums(parts: Iterable[tuple[str, Sequence[float]]]) -> list[tuple[str, list[float]]]:
    """Return sums by task, under the task's title, and over all."""
    sums: dict[str, list[float]] = {}
    for task, values in parts:
        before = sums.get(TITLES[task], [0.0] * len(values))
        sums[TITLES[task]] = [old + new for old, new in zip(before, values, strict=True)]
    whole = [sum(column) for column in zip(*sums.values(), strict=True)]
    return [*sums.items(), ("all", whole)] if sums else []


def _measured(table: Table) -> str:
    tasks = load_configuration("paper").tasks
    times = [
        [
            TITLES[task],
            *(number(table.get("short_run", task, method)) for method in ("hebb", "neat")),
            number(neat_seconds(table.get, task) * 1e6),
        ]
        for task in table.tasks
    ]
    header = ["measured", "µs a step: Hebb", "NEAT", "NEAT's µs of an evaluation"]
    lengths = [
        [
            TITLES[task],
            str(max(max(each) for each in of_task.values())),
            *(number(list(each.values())[-1]) for each in of_task.values()),
            number(tasks[task].max_steps),
        ]
        for task, of_task in recorded_lengths().items()
    ]
    methods = [method_label(each) for each in next(iter(recorded_lengths().values()))]
    of_lengths = ["steps of an evaluation in the records", "G", *methods, "limit"]
    return f"{markdown(header, times)}\n{markdown(of_lengths, lengths)}"


def _core_hours(costs: Iterable[Cost]) -> str:
    """Tabulate million evaluations and core-hours by task; runs of Table 1 are those of Table 3."""
    chosen = {(*key, *setting) for key, setting in settings(3).items()}
    parts = []
    for cost in costs:
        spec, task = cost.job.spec, cost.job.spec.task.name
        rate = spec.plasticity.learning_rate if spec.plasticity.learns else None
        shown = (task, spec.method, spec.population, rate) in chosen
        evaluations = cost.runs * spec.generations * spec.population * spec.evaluation.episodes
        parts.append((task, (evaluations, cost.seconds, cost.longest, shown * cost.seconds)))
    rows = [
        [task, f"{evaluations / 1e6:,.1f}", *(number(value / HOUR) for value in seconds)]
        for task, (evaluations, *seconds) in _sums(parts)
    ]
    header = ["core-hours", "million evaluations", "if as measured"]
    header += ["if every episode ran to its limit", "Table 1 alone, if as measured"]
    return markdown(header, rows)


def _runs(costs: Iterable[Cost]) -> str:
    """Tabulate minutes of one run by task, method and P, and hours of the longest job."""
    minutes: dict[tuple[str, str], dict[int, float]] = defaultdict(dict)
    most: dict[tuple[str, str], tuple[float, float, int]] = {}
    for cost in costs:
        spec = cost.job.spec
        key = (spec.task.name, "NEAT" if spec.method == "neat" else "a rule, NEAT (w/o)")
        minutes[key][spec.population] = cost.seconds / cost.runs / 60
        longest = (cost.seconds / HOUR, cost.longest / HOUR, cost.runs)
        most[key] = max(most.get(key, longest), longest)
    populations = sorted({population for found in minutes.values() for population in found})
    rows = [
        [
            f"{TITLES[task]}, {method}",
            *(number(found.get(population)) for population in populations),
            str(most[task, method][2]),
            *(number(hours) for hours in most[task, method][:2]),
        ]
        for (task, method), found in minutes.items()
    ]
    header = ["minutes of one run", *(f"P = {population}" for population in populations)]
    header += ["runs of a job", "hours of the longest job", "at the limit of steps"]
    return markdown(header, rows)


def _wall(costs: Sequence[Cost]) -> str:
    """Tabulate days on several cores, each of which takes the next job when it is free."""
    usual, longest = [cost.seconds for cost in costs], [cost.longest for cost in costs]
    rows = [
        [f"{cores:,}", number(_days(usual, cores)), number(_days(longest, cores))]
        for cores in CORES
    ]
    return markdown(("cores", "days, if as measured", "if every episode ran to its limit"), rows)


def _days(jobs: Iterable[float], cores: int) -> float:
    free = [0.0] * cores
    for seconds in jobs:
        heapq.heapreplace(free, free[0] + seconds)
    return max(free) / 24 / HOUR


if __name__ == "__main__":
    name = sys.argv[1] if len(sys.argv) > 1 else "paper"
    try:
        print(prediction(shipped, name))
        print(comparison(shipped, name))
        print(spent(name))
    except UserError as error:
        sys.exit(f"neol: {error}")
