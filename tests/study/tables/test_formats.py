"""Formats of printed values."""

import math

import pytest

from neol.pictures.labels import drawn, three_figures
from neol.spec.configuration import load_configuration
from neol.study.tables.formats import lines_of, marks


def test_every_reason_has_a_mark_of_its_own() -> None:
    found = marks(["", *(f"without seeds {seed}" for seed in range(53))])
    assert len(set(found.values())) == 53
    assert [*found.values()][::26] == ["(a)", "(aa)", "(aaa)"]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.45, "0.450"),
        (-12.0, "-12.0"),
        (99.97, "100"),
        (1234.5, "1234"),
        (-0.0, "0.00"),
        (math.nan, "--"),
        (math.inf, "inf"),
    ],
)
def test_numbers_have_three_figures(value: float, text: str) -> None:
    assert three_figures(value) == text


def test_pictures_have_a_minus_and_a_dash() -> None:
    assert [drawn(text) for text in ("-1.50", "--")] == ["−1.50", "–"]


def test_a_line_says_the_size_of_its_runs_where_tasks_differ() -> None:
    def labels(*overrides: str, setting: str = "table3") -> list[str]:
        here = load_configuration("smoke", ["budget.tasks=[cartpole, hopper]", *overrides])
        return [lines_of(here, setting, task, [], {})[0].label for task in here.budget.tasks]

    assert labels() == ["CartPole", "Hopper"]
    longer = "budget.generations={cartpole: 5, hopper: 2}"
    assert labels(longer) == ["CartPole (G = 5)", "Hopper (G = 2)"]
    more = "budget.seeds={cartpole: 4, hopper: 3}"
    assert labels(longer, more) == ["CartPole (G = 5, 4 seeds)", "Hopper (G = 2, 3 seeds)"]
    fewer = "budget.populations={cartpole: [6, 12], hopper: [6]}"
    assert labels(fewer) == ["CartPole (P = 6, 12)", "Hopper (P = 6)"]
    assert labels(fewer, setting="score") == ["CartPole (P = 12)", "Hopper (P = 6)"]
    papers = "budget.populations={cartpole: [50, 300], hopper: [300]}"
    papers_rate = "budget.learning_rates=[2.5e-4]"
    assert labels(papers, papers_rate) == ["CartPole (P = 50)", "Hopper (P = 300)"]
