"""The numbers of docs/scaling.md: core-hours of the paper's full budget, by task."""

from collections.abc import Mapping
from dataclasses import dataclass

from benchmarks.table import NEAT_POPULATION, TITLES, Table, markdown, number
from neol.analysis.reference import settings
from neol.spec import Configuration, load_configuration

BEGIN, END = "<!-- generated: begin -->", "<!-- generated: end -->"
LIKE = {"neat": "neat", "neat_wo": "hebb", "hebb": "hebb", "oja": "hebb", "bcm": "hebb"}
"""The method whose short runs stand for a method's evaluations."""


def replace_generated(text: str, generated: str) -> str:
    """The text with everything between its two markers replaced."""
    before, _, rest = text.partition(BEGIN)
    _, marker, after = rest.partition(END)
    assert marker, f"no {BEGIN} ... {END}"
    return f"{before}{BEGIN}\n{generated}\n{END}{after}"


def scaling(table: Table, about: Mapping[str, str]) -> str:
    """What was measured, and what it comes to."""
    configuration = load_configuration("paper")
    header = ["measured", "G", "µs a step: Hebb", "NEAT", "steps of an evaluation: Hebb", "NEAT"]
    header += ["in the last third: Hebb", "NEAT", "limit", "NEAT's µs of an evaluation"]
    names = ("short_run", "short_run_steps", "short_run_late_steps")
    measured = [
        [
            TITLES[task],
            number(table.get("short_run_generations", task)),
            *(
                number(table.get(name, task, method))
                for name in names
                for method in ("hebb", "neat")
            ),
            number(configuration.tasks[task].max_steps),
            number(_neat_cost(table, task)),
        ]
        for task in table.tasks
    ]
    hours = [_hours(table, task, configuration) for task in table.tasks]
    rows = [[TITLES[task], *h.row()] for task, h in zip(table.tasks, hours, strict=True)]
    rows.append(["all", *sum(hours, Hours()).row()])
    where = f"{about['CPU']}, {about['Date']} ({about['Run']})"
    columns = ["core-hours", "million evaluations", "if as measured"]
    columns += ["if every episode ran to its limit", "Table 1 alone, if as measured"]
    return f"On {where}:\n\n{markdown(header, measured)}\n{markdown(columns, rows)}"


@dataclass(frozen=True)
class Hours:
    """Core-hours of a task's runs."""

    evaluations: float = 0.0
    measured: float = 0.0
    limit: float = 0.0
    table_1: float = 0.0

    def __add__(self, other: "Hours") -> "Hours":
        return Hours(
            self.evaluations + other.evaluations,
            self.measured + other.measured,
            self.limit + other.limit,
            self.table_1 + other.table_1,
        )

    def row(self) -> list[str]:
        hours = (self.measured, self.limit, self.table_1)
        return [f"{self.evaluations / 1e6:,.1f}", *(number(value) for value in hours)]


def _hours(table: Table, task: str, configuration: Configuration) -> Hours:
    budget = configuration.budget
    total = Hours()
    for method in budget.methods:
        step = table.get("short_run", task, LIKE[method]) or 0.0
        steps = table.get("short_run_late_steps", task, LIKE[method]) or 0.0
        hour = 3600e6  # of microseconds
        usual = (steps * step + _neat_cost(table, task)) / hour
        longest = (configuration.tasks[task].max_steps * step + _neat_cost(table, task)) / hour
        rates = 1 if configuration.methods[method].rule == "none" else len(budget.learning_rates)
        runs_of_a_genome = budget.generations * budget.seeds
        evaluations = runs_of_a_genome * sum(budget.populations) * rates
        population, _ = settings(3).get((task, method), (0, None))
        total += Hours(
            evaluations,
            evaluations * usual,
            evaluations * longest,
            runs_of_a_genome * population * usual,
        )
    return total


def _neat_cost(table: Table, task: str) -> float:
    """Microseconds of NEAT for an evaluation, of a population grown for 200 generations."""
    return (table.get("neat_generation", task) or 0.0) * 1e3 / NEAT_POPULATION
