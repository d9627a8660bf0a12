"""Which budget is shown, and which of its tasks."""

from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.spec.configuration import load_configuration
from neol.study.campaign.shown import (
    DEFAULT_BUDGET,
    chosen_tasks,
    figures_folder,
    folder,
    label,
    select,
    snakemake_options,
)


def test_all_tasks_are_the_whole_budget() -> None:
    whole = load_configuration("demo")
    assert select("demo") == select("demo", "lunar_lander,cartpole") == whole
    assert chosen_tasks(whole.budget) == ()
    assert label(whole.budget) == "demo"
    assert snakemake_options(whole.budget) == "--config budget=demo"


def test_tasks_come_once_and_in_the_order_of_the_budget() -> None:
    some = select("paper", "hopper,cartpole,hopper")
    assert chosen_tasks(some.budget) == some.budget.tasks == ("cartpole", "hopper")
    assert label(some.budget) == "paper-cartpole,hopper"
    assert figures_folder(some.budget) == Path("figures/paper-cartpole,hopper")
    assert snakemake_options(some.budget) == "--config budget=paper tasks=cartpole,hopper"


def test_only_tasks_differ() -> None:
    whole, some = load_configuration("paper"), select("paper", "cartpole")
    assert some.budget.model_copy(update={"tasks": whole.budget.tasks}) == whole.budget
    assert some.model_copy(update={"budget": whole.budget}) == whole


def test_the_shown_budget_has_the_folder_itself() -> None:
    shown = select().budget
    assert shown.name == DEFAULT_BUDGET
    assert figures_folder(shown) == Path("figures")
    some = select(tasks="cartpole").budget
    assert figures_folder(some) == Path(f"figures/{DEFAULT_BUDGET}-cartpole")


@pytest.mark.parametrize(
    ("tasks", "line"),
    [
        ("cartpol", 'budget demo has no task "cartpol", did you mean "cartpole"? (allowed:'),
        ("cartpole,hopper", 'budget demo has no task "hopper" (allowed: cartpole, lunar_lander)'),
        ("cartpole,", 'budget demo has no task ""'),
    ],
)
def test_a_task_that_the_budget_lacks(tasks: str, line: str) -> None:
    with pytest.raises(UserError) as error:
        select("demo", tasks)
    assert str(error.value).startswith(line)


def test_a_folder_has_a_name() -> None:
    assert folder("a/b") == folder(Path("a/b")) == Path("a/b")
    with pytest.raises(UserError, match=r"^5: no name of a folder; papermill"):
        folder(5)
