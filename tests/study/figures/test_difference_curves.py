"""Differences over generations: by hand, drawn and in words."""

import pandas as pd
import pytest

from neol.pictures.style import png
from neol.study.figures.difference_curves import (
    describe_curves,
    differences_over_generations,
    draw_difference_curves,
)
from tests.helpers.made_up import configuration


def curves() -> pd.DataFrame:
    """Hebb and NEAT on Hopper: equal at first, then 10 apart with a spread of 1."""
    rows = [
        ("hopper", method, seed, generation, level + seed)
        for method, levels in {"hebb": (0.0, 10.0), "neat": (0.0, 0.0)}.items()
        for generation, level in enumerate(levels, 1)
        for seed in (0, 1, 2)
    ]
    return pd.DataFrame(rows, columns=["task", "method", "seed", "generation", "best_fitness"])


def test_differences_are_of_means_with_welchs_interval() -> None:
    table = differences_over_generations(curves())
    assert table["difference"].tolist() == [0.0, 10.0]
    assert table["against"].unique().tolist() == ["neat"]
    reach = 2.776445 * (1 / 3 + 1 / 3) ** 0.5  # t of 4 degrees; both variances are 1
    assert table["high"].to_numpy() == pytest.approx([reach, 10 + reach], rel=1e-5)
    assert table["low"].to_numpy() == pytest.approx([-reach, 10 - reach], rel=1e-5)


def test_only_generations_that_are_distinguishable_count() -> None:
    assert describe_curves(differences_over_generations(curves())) == [
        "Hopper, distinguishable from NEAT: Hebb 50% of generations higher."
    ]


def test_without_a_baseline_there_is_nothing() -> None:
    alone = curves()
    alone = alone[alone["method"] == "hebb"]
    table = differences_over_generations(alone)
    assert table.empty
    figure = draw_difference_curves(table, configuration(tasks=("hopper",)).budget, "note")
    assert png(figure).startswith(b"\x89PNG")


def test_it_is_drawn() -> None:
    table = differences_over_generations(curves())
    figure = draw_difference_curves(table, configuration(tasks=("hopper",)).budget, "note")
    assert figure.axes[0].get_title() == "Hopper"
    assert figure.axes[0].get_ylabel() == "Best fitness, minus NEAT's"
    assert png(figure).startswith(b"\x89PNG")
