"""What is said of results: never more than an interval allows."""

import math
from typing import Any

import pandas as pd
import pytest

from neol.study.outcomes.campaign_runs import Campaign
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
    assert words.told_apart(table, FITNESS, "neat") == [f"Hopper: BCM {said}."]


def test_rules_are_told_side_by_side() -> None:
    rows = [
        effects(method="bcm", difference=9.0, low=8.0, high=10.0),
        effects(method="hebb"),
        effects(method="oja", difference=8.0, low=7.0, high=9.0, near_control=True),
    ]
    (sentence,) = words.told_apart(pd.concat(rows), FITNESS, "neat")
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


def test_who_is_distinguishable_is_said_of_each_outcome() -> None:
    table = pd.concat([
        effects(method="bcm", low=0.6), effects(method="neat_wo", low=0.6), effects(method="oja"),
        effects(method="oja", task="cartpole", high=-0.4),
        effects(method="bcm", task="all", low=math.nan),
        effects(outcome="SCORE", against="neat_wo", method="hebb", low=0.6),
    ])  # fmt: skip
    assert words.summary(table)[:2] == [
        "Distinguishable from NEAT (the 95% interval of the difference of means excludes 0): "
        "in final fitness, BCM and NEAT (w/o) on Hopper (higher), Oja on CartPole (lower); in "
        "SCORE, none; in held-out return, none.",
        "Distinguishable from NEAT (w/o), which neither learns nor mutates weights: in final "
        "fitness, none; in SCORE, Hebb on Hopper (higher); in held-out return, none.",
    ]
    assert len(words.summary(table)) == 3


def test_near_control_is_no_success_of_a_rule() -> None:
    table = pd.concat([effects(low=0.6, near_control=True), effects(method="hebb", low=0.6)])
    first, *_, last = words.summary(table)
    assert "in final fitness, Hebb on Hopper (higher); in SCORE, none" in first
    assert last.startswith("No success of a rule, because it is near control")
    assert "in final fitness, BCM on Hopper (higher)" in last


def test_verdicts_are_counted_and_decided_questions_named() -> None:
    """Parts are not counted."""
    rows = [
        ("a", "all", "reproduced"), ("a", "hopper: bcm", "reproduced"), ("b", "all", "too short"),
        ("c", "all", "reproduced"), ("d", "all", "not reproduced"),
    ]  # fmt: skip
    ledger = pd.DataFrame(rows, columns=["question", "part", "verdict"])
    assert words.verdicts(ledger) == [
        "The paper's claims come down to 4 questions: 2 reproduced, 1 too short and 1 not "
        "reproduced.",
        "Reproduced: `a` and `c`.",
        "Not reproduced: `d`.",
    ]


def test_what_champions_get_again() -> None:
    columns = ["task", "mean", "held_out"]
    rows = [("hopper", 195.0, -187.0), ("hopper", 398.0, -56.0), ("cartpole", math.nan, math.nan)]
    assert words.flattered(pd.DataFrame(rows, columns=columns)) == [
        "Hopper: -187 to -56.0 again, 195 to 398 less than in training."
    ]


def test_the_share_of_generations_with_one_species(campaign: Campaign) -> None:
    assert words.one_species(campaign)[0].startswith("CartPole: BCM ")


def test_no_run_is_no_comparison() -> None:
    table = effects(seeds=0, difference=math.nan, low=math.nan, high=math.nan)
    (sentence,) = words.told_apart(table, FITNESS, "neat")
    assert sentence == "Hopper: BCM cannot be compared with NEAT."


def test_tests_are_counted_after_correction() -> None:
    table = pd.concat([effects(p_holm=0.01), effects(p_holm=0.05), effects(p_holm=math.nan)])
    assert words.after_correction(table).startswith(
        "Of 2 tests of the declared family (Welch's, two-sided), 1 have"
    )
    assert words.after_correction(table).endswith(
        "correction: final fitness, Hopper, BCM against NEAT."
    )


def test_readings_that_were_told_apart_are_named() -> None:
    columns = ["variant", "task", "method", "seeds", "pairs", "same", "a12", "low", "high"]
    rows = [
        ("baseline", "hopper", "bcm", 10, 10, 10, 0.5, 0.5, 0.5),
        ("beta 1", "hopper", "bcm", 10, 10, 0, 0.1, 0.0, 0.4),
        ("ReLU", "hopper", "neat", 10, 10, 0, 0.6, 0.3, 0.9),
        ("literal sharing", "hopper", "neat", 10, 10, 10, 0.5, 0.5, 0.5),
        ("ReLU", "cartpole", "neat", 10, 10, 0, 0.5, 0.5, 0.5),
        ("sigmoid", "cartpole", "neat", 0, 0, 0, math.nan, math.nan, math.nan),
    ]
    assert words.told_by_sensitivity(pd.DataFrame(rows, columns=columns)) == [
        "Hopper: plasticity.reward_scale=1.0 (BCM) 0.10 [0.00, 0.40], of 2 that acted.",
        "CartPole: none, of 1 that acted.",
        "All together: 1 of 3; if no reading mattered, at most about 0 would be by chance.",
        "Acted on nothing, each run being the baseline's, in 1 trials: neat.sharing=literal.",
    ]
    nothing = pd.DataFrame(rows[5:], columns=columns)
    assert words.told_by_sensitivity(nothing) == ["None of the study's runs is there."]
