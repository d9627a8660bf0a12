"""Selection of what tables and figures show: a budget, a reading, and some or all tasks."""

import json
from collections.abc import Sequence
from pathlib import Path

from neol.base.errors import UserError, hint
from neol.spec.configuration import Configuration, load_configuration
from neol.spec.constants import Budget
from neol.spec.readings import DEFAULT_READING
from neol.spec.sources import by_dotted_key
from neol.study.campaign.grid import check_shared_records

DEFAULT_BUDGET = "evidence"
"""Budget that is shown by default."""
TWO_BY_TWO = "two_by_two"
"""Budget of the rules with weight mutation, which the paper does not have."""


def select(
    budget: str = DEFAULT_BUDGET, tasks: str = "", reading: str = DEFAULT_READING
) -> Configuration:
    """Return a budget's configuration with all of its tasks, or the named ones: "cartpole,hopper".

    Raises UserError for an unknown budget or reading, a task that the budget does not have, or
    records of another budget that are not that budget's.
    """
    if str(budget).endswith(".yaml"):
        raise UserError(f"{budget}: a campaign needs a budget of config/; copy this file to there")
    configuration = load_configuration(budget, reading=reading)
    check_shared_records(configuration)
    all_tasks = configuration.budget.tasks
    chosen = tasks.split(",") if tasks else all_tasks
    for task in chosen:
        if task not in all_tasks:
            raise UserError(f'budget {budget} has no task "{task}"{hint(task, all_tasks)}')
    return with_tasks(configuration, [task for task in all_tasks if task in chosen])


def two_by_two(configuration: Configuration) -> list[Configuration]:
    """Return budgets whose rules with weight mutation can be compared with a budget's methods.

    They have the same numbers of generations on the same tasks.
    """
    other = load_configuration(TWO_BY_TWO, reading=configuration.reading)
    ours, theirs = configuration.budget, other.budget
    same = [task in ours.tasks and _as_long(ours, theirs, task) for task in theirs.tasks]
    return [other] if all(same) and ours.name != TWO_BY_TWO else []


def _as_long(one: Budget, other: Budget, task: str) -> bool:
    return one.generations_of(task) == other.generations_of(task)


def folder(name: object) -> Path:
    """Return the folder that a notebook's parameter names. Raises UserError if it is not text."""
    if not isinstance(name, str | Path):
        raise UserError(
            f"{name!r}: not the name of a folder; papermill passes even a number as text after -r"
        )
    return Path(name)


def with_tasks(configuration: Configuration, tasks: Sequence[str]) -> Configuration:
    """Return the configuration with other tasks."""
    budget = configuration.budget.model_copy(update={"tasks": tuple(tasks)})
    return configuration.model_copy(update={"budget": budget})


def chosen_tasks(budget: Budget) -> tuple[str, ...]:
    """Return the tasks of a budget if they are fewer than in its file, otherwise none."""
    all_tasks = load_configuration(budget.name).budget.tasks
    return () if budget.tasks == all_tasks else budget.tasks


def label(configuration: Configuration) -> str:
    """Return the selection as a path: paper, or paper-cartpole,hopper for some of its tasks.

    For a reading other than the default one its name comes first: first/paper.
    """
    return full_label(configuration).removeprefix(f"{DEFAULT_READING}/")


def full_label(configuration: Configuration) -> str:
    """Return the selection as a path that always has the reading: first/paper-cartpole,hopper."""
    budget, tasks = configuration.budget.name, chosen_tasks(configuration.budget)
    return f"{configuration.reading}/{'-'.join([budget, ','.join(tasks)] if tasks else [budget])}"


def figures_folder(configuration: Configuration) -> Path:
    """Return the folder of its tables and figures: figures/, or figures/paper-cartpole."""
    name = label(configuration)
    return Path("figures", "" if name == DEFAULT_BUDGET else name)


def results_page(configuration: Configuration) -> Path:
    """Return its page of results: docs/results.md, or docs/results-demo.md."""
    name = label(configuration).replace("/", "-")
    return Path("docs") / ("results.md" if name == DEFAULT_BUDGET else f"results-{name}.md")


def snakemake_options(configuration: Configuration) -> str:
    """Return the options of snakemake for it: --config budget=paper tasks=cartpole."""
    options = {"budget": configuration.budget.name}
    if configuration.reading != DEFAULT_READING:
        options["reading"] = configuration.reading
    if tasks := chosen_tasks(configuration.budget):
        options["tasks"] = ",".join(tasks)
    return " ".join(["--config", *(f"{name}={value}" for name, value in options.items())])


def differs_from_default(configuration: Configuration) -> dict[str, tuple[str, str]]:
    """Return each constant that differs from the default reading: its value and the default's.

    Keys look like neat.elitism. The budget and constants that it sets are omitted.
    """
    here, default = (
        by_dotted_key(each.model_dump(mode="json", exclude={"reading", "budget"}))
        for each in (configuration, load_configuration(configuration.budget.name))
    )
    return {
        key: (_text(here[key]), _text(default[key])) for key in here if here[key] != default[key]
    }


def _text(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)
