"""What tables and figures show: a budget, with all of its tasks or some."""

from collections.abc import Sequence
from pathlib import Path

from neol.base.errors import UserError, hint
from neol.spec.configuration import Configuration, load_configuration
from neol.spec.constants import Budget

DEFAULT_BUDGET = "desk"
"""Where none is named."""
FIGURES = Path("figures")


def select(budget: str = DEFAULT_BUDGET, tasks: str = "") -> Configuration:
    """A budget's configuration; with some of its tasks only if they are named: "cartpole,hopper".

    Raises UserError for an unknown budget, or a task that the budget does not have.
    """
    configuration = load_configuration(budget)
    all_tasks = configuration.budget.tasks
    chosen = tasks.split(",") if tasks else all_tasks
    for task in chosen:
        if task not in all_tasks:
            raise UserError(f'budget {budget} has no task "{task}"{hint(task, all_tasks)}')
    return with_tasks(configuration, [task for task in all_tasks if task in chosen])


def folder(name: object) -> Path:
    """A folder as a notebook's parameter names it. Raises UserError for what is no text."""
    if not isinstance(name, str | Path):
        raise UserError(
            f"{name!r}: no name of a folder; papermill passes even a number as text after -r"
        )
    return Path(name)


def with_tasks(configuration: Configuration, tasks: Sequence[str]) -> Configuration:
    """The same budget with other tasks."""
    budget = configuration.budget.model_copy(update={"tasks": tuple(tasks)})
    return configuration.model_copy(update={"budget": budget})


def chosen_tasks(budget: Budget) -> tuple[str, ...]:
    """The tasks of a budget if they are not all that its file has, otherwise none."""
    all_tasks = load_configuration(budget.name).budget.tasks
    return () if budget.tasks == all_tasks else budget.tasks


def label(budget: Budget) -> str:
    """What its folders are called: paper, or paper-cartpole,hopper."""
    tasks = chosen_tasks(budget)
    return f"{budget.name}-{','.join(tasks)}" if tasks else budget.name


def figures_folder(budget: Budget) -> Path:
    """Where its tables and figures are: figures/, or figures/paper-cartpole."""
    return FIGURES if label(budget) == DEFAULT_BUDGET else FIGURES / label(budget)


def snakemake_options(budget: Budget) -> str:
    """What the workflow is told: --config budget=paper tasks=cartpole."""
    tasks = chosen_tasks(budget)
    return f"--config budget={budget.name}" + (f" tasks={','.join(tasks)}" if tasks else "")
