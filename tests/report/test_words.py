"""What is said of results: never more than an interval allows."""

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

from neol.analysis.claims import NOT_IN_BUDGET, SEEDS_MISSING, TOO_FEW, TOO_SHORT
from neol.report import words
from neol.spec import load_configuration
from tests.analysis.made_up import configuration


def effects(**row: Any) -> pd.DataFrame:
    """One comparison with NEAT on Hopper."""
    there = {"comparison": words.FITNESS, "task": "hopper", "method": "bcm", "seeds": 10}
    return pd.DataFrame([there | {"a12": 0.5, "low": 0.2, "high": 0.8, "p_holm": 1.0} | row])


@pytest.mark.parametrize(
    ("a12", "low", "high", "said"),
    [
        (0.9, 0.51, 1.0, "above NEAT"),
        (0.9, 0.5, 1.0, "not told apart from NEAT"),
        (0.1, 0.0, 0.5, "not told apart from NEAT"),
        (0.1, 0.0, 0.49, "below NEAT"),
    ],
)
def test_a_rule_is_above_or_below_only_where_its_interval_is(
    a12: float, low: float, high: float, said: str
) -> None:
    table = effects(a12=a12, low=low, high=high)
    assert words.told_apart(table, words.FITNESS) == [
        f"Hopper: BCM {a12:.2f} [{low:.2f}, {high:.2f}] {said}."
    ]


def test_rules_are_told_side_by_side() -> None:
    rows = [
        effects(method="bcm", a12=0.9, low=0.8, high=1.0),
        effects(method="hebb"),
        effects(method="oja", a12=0.8, low=0.7, high=1.0),
    ]
    (sentence,) = words.told_apart(pd.concat(rows), words.FITNESS)
    assert sentence == (
        "Hopper: BCM 0.90 [0.80, 1.00], Oja 0.80 [0.70, 1.00] above NEAT; "
        "Hebb 0.50 [0.20, 0.80] not told apart from NEAT."
    )


def test_no_run_is_no_comparison() -> None:
    table = effects(seeds=0, a12=math.nan, low=math.nan, high=math.nan)
    (sentence,) = words.told_apart(table, words.FITNESS)
    assert sentence == "Hopper: BCM cannot be compared with NEAT."


def test_tests_are_counted_after_correction() -> None:
    table = pd.concat([effects(p_holm=0.01), effects(p_holm=0.05), effects(p_holm=math.nan)])
    assert words.after_correction(table).startswith(
        "Of 2 one-sided tests of the declared family, 1"
    )
    assert words.after_correction(table).endswith("correction: final fitness, Hopper, BCM.")


def test_readings_that_were_told_apart_are_named() -> None:
    columns = ["variant", "task", "method", "pairs", "a12", "low", "high"]
    rows = [
        ("baseline", "hopper", "bcm", 10, 0.5, 0.5, 0.5),
        ("beta 1", "hopper", "bcm", 10, 0.1, 0.0, 0.4),
        ("ReLU", "hopper", "neat", 10, 0.6, 0.3, 0.9),
        ("ReLU", "cartpole", "neat", 10, 0.5, 0.5, 0.5),
        ("sigmoid", "cartpole", "neat", 0, math.nan, math.nan, math.nan),
    ]
    assert words.told_by_sensitivity(pd.DataFrame(rows, columns=columns)) == [
        "Hopper: beta 1 (BCM) 0.10 [0.00, 0.40], of 2 that were tried.",
        "CartPole: none, of 1 that were tried.",
        "All together: 1 of 3; if no reading mattered, about 0 would be by chance.",
    ]
    nothing = pd.DataFrame(rows[4:], columns=columns)
    assert words.told_by_sensitivity(nothing) == ["None of the study's runs is there."]


def ledger(*parts: tuple[str, str, float]) -> pd.DataFrame:
    """Open claims: of each part its claim, why it is open, and the seeds it needs."""
    table = pd.DataFrame(parts, columns=["claim", "reason", "seeds_needed"])
    table["reason"] = table["reason"].replace("", np.nan)
    return table.assign(verdict="undecided", part_verdict="undecided")


def test_an_open_claim_counts_where_it_lacks_the_most() -> None:
    table = ledger(
        ("few seeds", TOO_FEW, 12), ("few seeds", "", 29),
        ("more seeds", "", 12), ("more seeds", "", 31),
        ("no difference", "", math.inf),
        ("indistinguishable", "", math.nan),
        ("higher level", "", 12), ("higher level", TOO_SHORT, 12),
        ("elsewhere", TOO_SHORT, 12), ("elsewhere", NOT_IN_BUDGET, math.nan),
        ("under way", SEEDS_MISSING, 12),
    )  # fmt: skip
    table.loc[len(table)] = ["decided", np.nan, 12, "supported", "supported"]
    steps = words.steps(table, configuration())
    assert [(step.takes, step.claims) for step in steps] == [
        ("the rest of this budget's runs", 1),
        ("30 seeds instead of 3", 2),
        ("100 seeds instead of 3", 1),
        ("more seeds than that: little or no difference is seen here", 1),
        ("500 generations", 1),
        ("cells that this budget does not have: the paper's budget", 1),
    ]
    assert words.lacks(table[table["claim"] == "more seeds"]) == "31 seeds"
    assert words.lacks(table[table["claim"] == "no difference"]) == "more than 1000 seeds"
    assert words.lacks(table[table["claim"] == "higher level"]) == TOO_SHORT


def test_core_hours_grow_with_seeds_and_generations() -> None:
    demo = load_configuration("demo")
    hours = words.core_hours(demo, seeds=10)
    assert hours
    assert words.core_hours(demo, seeds=30) == pytest.approx(3 * hours)
    half = words.core_hours(demo, seeds=10, generations=demo.budget.generations // 2)
    assert half == pytest.approx(hours / 2)
    # Beyond the generations that were measured a generation costs what the last of those did.
    later = [words.core_hours(demo, seeds=10, generations=each) for each in (600, 1200, 1800)]
    assert later[0] > 10 * hours
    assert later[2] - later[1] == pytest.approx(later[1] - later[0])
