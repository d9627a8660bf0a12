"""Which budget is shown, and which of its tasks."""

from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.spec.configuration import load_configuration
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.shown import (
    DEFAULT_BUDGET,
    chosen_tasks,
    differs_from_default,
    figures_folder,
    folder,
    full_label,
    label,
    results_page,
    select,
    snakemake_options,
)


def test_all_tasks_are_the_whole_budget() -> None:
    whole = load_configuration("demo", reading=DEFAULT_READING)
    assert select("demo") == select("demo", "lunar_lander,cartpole") == whole
    assert chosen_tasks(whole.budget) == ()
    assert label(whole) == "demo"
    assert snakemake_options(whole) == "--config budget=demo"


def test_tasks_come_once_and_in_the_order_of_the_budget() -> None:
    some = select("paper", "hopper,cartpole,hopper")
    assert chosen_tasks(some.budget) == some.budget.tasks == ("cartpole", "hopper")
    assert label(some) == "paper-cartpole,hopper"
    assert full_label(some) == f"{DEFAULT_READING}/paper-cartpole,hopper"
    assert figures_folder(some) == Path("figures/paper-cartpole,hopper")
    assert results_page(some) == Path("docs/results-paper-cartpole,hopper.md")
    assert snakemake_options(some) == "--config budget=paper tasks=cartpole,hopper"


def test_another_reading_has_folders_of_its_own() -> None:
    reading = "worked_example+plasticity.reward_scale=0.1"
    other = select("desk", "hopper,cartpole", reading)
    assert label(other) == full_label(other) == f"{reading}/desk-cartpole,hopper"
    assert figures_folder(other) == Path("figures", reading, "desk-cartpole,hopper")
    assert results_page(other) == Path(f"docs/results-{reading}-desk-cartpole,hopper.md")
    options = snakemake_options(other)
    assert options == f"--config budget=desk reading={reading} tasks=cartpole,hopper"


def test_what_differs_from_the_default_reading() -> None:
    assert differs_from_default(select("smoke", reading=DEFAULT_READING)) == {}
    base = {
        "neat.weight_mutate_rate": ("0.8", "0.1"),
        "neat.weight_replace_rate": ("0.1", "0.01"),
        "neat.bias_mutate_rate": ("0.7", "0.1"),
        "neat.bias_replace_rate": ("0.1", "0.01"),
    }
    assert differs_from_default(select("smoke", "cartpole", "worked_example")) == base
    more = select("smoke", reading="worked_example+methods.neat.weight_mutation=0.1")
    assert differs_from_default(more) == base | {"methods.neat.weight_mutation": ("0.1", "config")}


def test_only_tasks_differ() -> None:
    whole, some = select("paper"), select("paper", "cartpole")
    assert some.budget.model_copy(update={"tasks": whole.budget.tasks}) == whole.budget
    assert some.model_copy(update={"budget": whole.budget}) == whole


def test_the_shown_budget_has_the_folder_itself() -> None:
    shown = select()
    assert (shown.budget.name, shown.reading) == (DEFAULT_BUDGET, DEFAULT_READING)
    assert figures_folder(shown) == Path("figures")
    assert results_page(shown) == Path("docs/results.md")
    some = select(tasks="cartpole")
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
    with pytest.raises(UserError, match=r"^5: not the name of a folder; papermill"):
        folder(5)
