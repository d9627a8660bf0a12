"""What open claims lack, and what that would cost."""

import math

import numpy as np
import pandas as pd
import pytest

from neol.spec.configuration import load_configuration
from neol.study.campaign.shown import select
from neol.study.claims import open_claims
from neol.study.claims.claims import NO_SUCH_CELL, SEEDS_MISSING, TOO_FEW, TOO_SHORT


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
        ("elsewhere", TOO_SHORT, 12), ("elsewhere", NO_SUCH_CELL, math.nan),
        ("under way", SEEDS_MISSING, 12),
    )  # fmt: skip
    table.loc[len(table)] = ["decided", np.nan, 12, "supported", "supported"]
    steps = open_claims.steps(table, load_configuration("smoke"))
    assert [(step.takes, step.claims) for step in steps] == [
        ("the rest of this budget's runs", 1),
        ("30 seeds instead of 3", 2),
        ("100 seeds instead of 3", 1),
        ("more seeds than that: little or no difference is seen here", 1),
        ("500 generations", 1),
        ("cells that this budget does not have: the paper's budget", 1),
    ]
    assert open_claims.lacks(table[table["claim"] == "more seeds"]) == "about 31 seeds"
    assert open_claims.lacks(table[table["claim"] == "no difference"]) == "more than 1000 seeds"
    assert open_claims.lacks(table[table["claim"] == "higher level"]) == TOO_SHORT


def test_what_is_not_shown_is_not_what_the_budget_lacks() -> None:
    """Of the tasks that were left out, it is the budget that has them."""
    some = select("demo", "cartpole")
    (step,) = open_claims.steps(ledger(("elsewhere", NO_SUCH_CELL, math.nan)), some)
    assert step.takes == "tasks that are not shown here"
    demo = load_configuration("demo")
    assert float(step.core_hours) == pytest.approx(open_claims.core_hours(demo, 10), rel=0.01)


def test_core_hours_grow_with_seeds_and_generations() -> None:
    demo = load_configuration("demo")
    hours = open_claims.core_hours(demo, seeds=10)
    assert hours
    assert open_claims.core_hours(demo, seeds=30) == pytest.approx(3 * hours)
    half = open_claims.core_hours(demo, seeds=10, generations=demo.budget.generations // 2)
    assert half == pytest.approx(hours / 2)
    # Beyond the generations that were measured a generation costs what the last of those did.
    later = [open_claims.core_hours(demo, seeds=10, generations=each) for each in (600, 1200, 1800)]
    assert later[0] > 10 * hours
    assert later[2] - later[1] == pytest.approx(later[1] - later[0])
