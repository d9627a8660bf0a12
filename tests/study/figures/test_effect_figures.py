"""Captions and marks in pictures of effects; their look was judged by eye."""

import math

import pandas as pd
from matplotlib.figure import Figure

from neol.study.figures import effect_figures
from tests.helpers.made_up import configuration

BUDGET = configuration(tasks=("hopper",)).budget


def footer(figure: Figure) -> str:
    return figure.get_supxlabel().replace("\n", " ")


def test_trials_that_lack_seeds_say_how_many_they_have() -> None:
    rows = [
        ("baseline", "hopper", "bcm", 3, 3, 0, 3, 0.5, 0.5, 0.5),
        ("ReLU", "hopper", "bcm", 3, 3, 0, 3, 0.7, 0.4, 0.9),
        ("sigmoid", "hopper", "bcm", 2, 3, 0, 2, 0.7, 0.4, 0.9),
        ("beta 0.1", "hopper", "bcm", 3, 3, 2, 1, 0.7, 0.4, 0.9),
        ("beta 1", "hopper", "bcm", 0, 3, 0, 0, math.nan, math.nan, math.nan),
    ]
    counts = ["seeds", "planned", "without_value", "pairs"]
    columns = ["variant", "task", "method", *counts, "a12", "low", "high"]
    table = pd.DataFrame(rows, columns=columns)
    figure = effect_figures.draw_sensitivity(table, BUDGET, note="Made up.")
    assert [text.get_text() for text in figure.axes[0].texts] == ["2/3", "1/3", "0/3"]
    assert "Seeds are missing: 2 of 5 trials are incomplete." in footer(figure)
    assert "Left out: 2 runs whose champion failed in all fresh episodes." in footer(figure)
    whole = effect_figures.draw_sensitivity(table[:2], BUDGET, note="Made up.")
    assert "missing" not in footer(whole)
    assert "Left out" not in footer(whole)
    assert "A mark without a line" not in footer(whole)
    certain = table[:2].assign(a12=1.0, low=1.0, high=1.0)
    figure = effect_figures.draw_sensitivity(certain, BUDGET, note="Made up.")
    assert "A mark without a line" in footer(figure)
    empty = effect_figures.draw_sensitivity(table[:0], BUDGET, note="No such task.")
    assert not empty.axes[0].axison
    assert "No such task." in footer(empty)


def test_a_profile_is_drawn_as_the_steps_that_it_is() -> None:
    rows = [("bcm", -0.5, 1.0, 1.0, 1.0), ("bcm", 0.0, 0.5, 0.0, 1.0), ("bcm", 1.5, 0.0, 0.0, 0.0)]
    table = pd.DataFrame(rows, columns=["method", "threshold", "share", "low", "high"])
    (axis,) = effect_figures.draw_profiles(table, BUDGET, "Made up.").axes
    (line,) = axis.lines
    assert line.get_drawstyle() == "steps-post"
    assert line.get_xydata().tolist() == [[-0.5, 1.0], [0.0, 0.5], [1.5, 0.0]]


def test_the_range_of_equal_cost_is_said() -> None:
    columns = ["metric", "compared", "task", "method", "population"]
    columns += ["mean", "low", "high", "first", "last"]
    rows = [
        ("equal_evaluations", "populations", "hopper", "bcm", 6, 1.0, 0.0, 2.0, 300.0, 25_000.0),
        ("equal_steps", "populations", "hopper", "bcm", 6, math.nan, math.nan, math.nan, 9.0, 8.0),
    ]
    table = pd.DataFrame(rows, columns=columns)
    said = footer(effect_figures.draw_efficiency(table, BUDGET, "Made up."))
    assert "Equal in all sizes: Hopper, 300 to 25,000 evaluations." in said
    said = footer(effect_figures.draw_efficiency(table[1:], BUDGET, "Made up."))
    assert "Equal in all sizes: Hopper, no common range." in said


def test_runs_without_a_held_out_value_are_counted() -> None:
    columns = ["task", "method", "population", "seeds", "without_value", "mean", "low", "high"]
    table = pd.DataFrame([("hopper", "bcm", 6, 3, 2, 1.0, 0.0, 2.0)], columns=columns)
    figure = effect_figures.draw_selection_bias(table, BUDGET, "Made up.")
    assert "Left out: 2 runs whose champion failed" in footer(figure)
    whole = effect_figures.draw_selection_bias(table.assign(without_value=0), BUDGET, "Made up.")
    assert "Left out" not in footer(whole)


def test_tasks_without_a_threshold_are_said() -> None:
    table = pd.DataFrame(
        [("hopper", "bcm", 1.0, 0.5, 1.5)], columns=["task", "method", "iqm", "low", "high"]
    )
    figure = effect_figures.draw_aggregates(table, BUDGET, "Made up.")
    assert "no threshold" not in footer(figure)
    other = BUDGET.model_copy(update={"tasks": ("hopper", "acrobot")})
    figure = effect_figures.draw_aggregates(table, other, "Made up.")
    assert "Left out (no reward threshold): Acrobot." in footer(figure)
