"""Sentences on results never say more than an interval allows."""

import math
from typing import Any

import pandas as pd
import pytest

from neol.study.outcomes.effects import FITNESS
from neol.study.report import words


def effects(**row: Any) -> pd.DataFrame:
    """One comparison with NEAT on Hopper."""
    there = {"outcome": FITNESS, "task": "hopper", "method": "bcm", "seeds": 10}
    there |= {"against": "neat"}
    there |= {"difference": 0.0, "low": -3.0, "high": 3.0, "near_control": False}
    return pd.DataFrame([there | {"a12": 0.5, "p_holm": 1.0} | row])


@pytest.mark.parametrize(
    ("difference", "low", "high", "said"),
    [
        (9.0, 0.5, 17.5, "9.00 [0.500, 17.5] higher than NEAT"),
        (9.0, 0.0, 18.0, "9.00 [0.00, 18.0] not distinguishable from NEAT"),
        (-9.0, -18.0, 0.0, "-9.00 [-18.0, 0.00] not distinguishable from NEAT"),
        (-9.0, -17.5, -0.5, "-9.00 [-17.5, -0.500] lower than NEAT"),
    ],
)
def test_a_rule_is_higher_or_lower_only_where_its_interval_is(
    difference: float, low: float, high: float, said: str
) -> None:
    table = effects(difference=difference, low=low, high=high)
    assert words.differences(table, FITNESS, "neat") == [f"Hopper: BCM {said}."]


def test_rules_are_listed_side_by_side() -> None:
    rows = [
        effects(method="bcm", difference=9.0, low=8.0, high=10.0),
        effects(method="hebb"),
        effects(method="oja", difference=8.0, low=7.0, high=9.0, near_control=True),
    ]
    (sentence,) = words.differences(pd.concat(rows), FITNESS, "neat")
    assert sentence == (
        "Hopper: BCM 9.00 [8.00, 10.0], Oja 8.00 [7.00, 9.00]† higher than NEAT; "
        "Hebb 0.00 [-3.00, 3.00] not distinguishable from NEAT."
    )
    assert words.effects_table(pd.concat(rows), "neat") == [
        ["outcome", "task", "BCM", "Hebb", "Oja"],
        [
            FITNESS,
            "Hopper",
            "**9.00 [8.00, 10.0]**; 0.50",
            "0.00 [-3.00, 3.00]; 0.50",
            "8.00 [7.00, 9.00]†; 0.50",
        ],
    ]


def test_no_run_is_no_comparison() -> None:
    table = effects(seeds=0, difference=math.nan, low=math.nan, high=math.nan)
    (sentence,) = words.differences(table, FITNESS, "neat")
    assert sentence == "Hopper: BCM cannot be compared with NEAT."


def test_tests_are_counted_after_correction() -> None:
    table = pd.concat([effects(p_holm=0.01), effects(p_holm=0.05), effects(p_holm=math.nan)])
    assert words.after_correction(table).startswith(
        "Of 2 tests of single rules (Welch's, two-sided), 1 have"
    )
    assert words.after_correction(table).endswith(
        "correction: final fitness, Hopper, BCM against NEAT."
    )


def test_constants_that_matter_are_named() -> None:
    columns = ["variant", "task", "method", "seeds", "pairs", "same", "a12", "low", "high"]
    rows = [
        ("baseline", "hopper", "bcm", 10, 10, 10, 0.5, 0.5, 0.5),
        ("beta 1", "hopper", "bcm", 10, 10, 0, 0.1, 0.0, 0.4),
        ("ReLU", "hopper", "neat", 10, 10, 0, 0.6, 0.3, 0.9),
        ("literal sharing", "hopper", "neat", 10, 10, 10, 0.5, 0.5, 0.5),
        ("ReLU", "cartpole", "neat", 10, 10, 0, 0.5, 0.5, 0.5),
        ("sigmoid", "cartpole", "neat", 0, 0, 0, math.nan, math.nan, math.nan),
    ]
    assert words.sensitive_constants(pd.DataFrame(rows, columns=columns)) == [
        "Hopper: plasticity.reward_scale=1.0 (BCM) 0.10 [0.00, 0.40], of 2 variants.",
        "CartPole: none, of 1 variants.",
        "In all, 1 of 3 variants; chance alone would give about 0.",
        "1 further trials changed nothing, because every run equals the baseline's: "
        "neat.sharing=literal.",
    ]
    nothing = pd.DataFrame(rows[5:], columns=columns)
    assert words.sensitive_constants(nothing) == ["No run of the sensitivity study is here."]


def test_the_best_cells_of_a_heat_map_are_named() -> None:
    columns = ["method", "population", "learning_rate", "mean", "near_best"]
    rows = [
        ("hebb", 50, 0.25, 1.0, False), ("hebb", 100, 0.25, 3.0, True),
        ("hebb", 100, 0.025, 2.0, True), ("neat", 50, math.nan, 1.0, True),
        ("oja", 50, 0.25, math.nan, False),
    ]  # fmt: skip
    assert words.best_cells(pd.DataFrame(rows, columns=columns)) == [
        "Hebb: P = 100, eta = 0.25 is best (3.00); one other cell is not distinguishable from it.",
        "NEAT: P = 50 is best (1.00); 0 of 0 other cells are not distinguishable from it.",
    ]
