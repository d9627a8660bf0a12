"""A reading's baselines beside the paper's: predictive intervals, distances, ranking."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from neol.base.errors import UserError
from neol.study.campaign.search import SCREENING, baseline_blocks
from neol.study.outcomes.baselines import (
    comparisons,
    paper_number,
    predictive_mean,
    predictive_sd,
    ranking,
    to_confirm,
)
from tests.helpers.baselines import PAPER, write_baseline
from tests.helpers.refusal import refusal


def test_the_papers_numbers_are_those_of_its_tables() -> None:
    assert paper_number("neat", "final") == (311.77, 8.18)
    assert paper_number("neat_wo", "final") == (312.50, 8.97)
    mean, sd = paper_number("neat_wo", "mean")
    assert (mean, sd) == pytest.approx((0.429e8 / 150_000, 0.0136e8 / 150_000))


def test_predictive_intervals_by_hand() -> None:
    sample = np.array([1.0, 2.0, 3.0])  # mean 2, SD 1
    reach = 9.924843 * math.sqrt(1 / 3 + 1 / 30)  # Student's 0.995 quantile, 2 degrees of freedom
    assert predictive_mean(sample) == pytest.approx((2 - reach, 2 + reach))
    low, high = predictive_sd(sample)
    # F(29, 2) is below 1 / F(2, 29)'s 0.995 quantile, 6.396, with 0.5%, and above 199.46 with 0.5%
    assert (low, high) == pytest.approx((math.sqrt(1 / 6.396), math.sqrt(199.46)), rel=1e-3)


def test_predictive_intervals_hold_thirty_further_runs_as_often_as_they_say() -> None:
    random = np.random.default_rng(0)
    inside = np.zeros(2)
    trials = 2000
    for _ in range(trials):
        ours, papers = random.normal(300.0, 8.0, 10), random.normal(300.0, 8.0, 30)
        (low, high), (least, most) = predictive_mean(ours), predictive_sd(ours)
        inside += low <= papers.mean() <= high, least <= papers.std(ddof=1) <= most
    assert (inside / trials).tolist() == pytest.approx([0.99, 0.99], abs=0.008)


def test_a_reading_with_the_papers_numbers_is_compatible(tmp_path: Path) -> None:
    write_baseline(tmp_path, "worked_example", "neat", PAPER["neat"])
    write_baseline(tmp_path, "worked_example", "neat_wo", PAPER["neat_wo"])
    table, sources, core_hours = comparisons(["worked_example"], SCREENING, tmp_path)
    assert (len(sources), core_hours) == (6, 0.0)
    ranked = ranking(table, 3)
    assert ranked["counting"].tolist() == ["of the generation", "so far"]
    assert ranked["compatible"].all()  # their best only rises, so it is always the best so far
    assert (ranked["distance"] < 0.1).all()


def test_the_best_so_far_is_counted_apart(tmp_path: Path) -> None:
    """A best that falls from 330 to 290 has a mean of 310; so far it is 330 throughout."""
    write_baseline(tmp_path, "worked_example", "neat", (290.0, 8.0, 310.0))
    table, _, _ = comparisons(["worked_example"], SCREENING, tmp_path)
    means = table[table["method"] == "neat"].set_index(["counting", "quantity"])["mean"].to_dict()
    assert means == pytest.approx(
        {
            ("of the generation", "final"): 290.0,
            ("of the generation", "mean"): 310.0,
            ("so far", "final"): 330.0,
            ("so far", "mean"): 330.0,
        }
    )


def test_one_number_that_does_not_fit_is_enough(tmp_path: Path) -> None:
    write_baseline(tmp_path, "worked_example", "neat", (320.0, 8.18, 291.3))
    write_baseline(tmp_path, "worked_example", "neat_wo", (312.5, 8.97, 100.0))
    table, _, _ = comparisons(["worked_example"], SCREENING, tmp_path)
    rows = table[table["counting"] == "of the generation"].set_index(["method", "quantity"])
    assert rows["compatible"].to_dict() == {
        ("neat", "final"): True,
        ("neat", "mean"): True,
        ("neat_wo", "final"): True,
        ("neat_wo", "mean"): False,
    }
    assert rows.loc[("neat", "final"), "distance"] == pytest.approx((320 - 311.77) / 8.18)
    best = ranking(table, 3).set_index("counting").loc["of the generation"]
    assert not best["compatible"]
    assert best["distance"] == rows["distance"].max()


def test_a_spread_far_from_the_papers_is_not_compatible(tmp_path: Path) -> None:
    write_baseline(tmp_path, "worked_example", "neat", (311.77, 300.0, 291.3))
    table, _, _ = comparisons(["worked_example"], SCREENING, tmp_path)
    rows = table.set_index(["counting", "method", "quantity"])
    final = rows.loc[("of the generation", "neat", "final")]
    assert final["mean_low"] < 311.77 < final["mean_high"]
    assert not final["compatible"]


def test_readings_share_runs_of_neat_without_mutation(tmp_path: Path) -> None:
    write_baseline(tmp_path, "worked_example", "neat_wo", PAPER["neat_wo"])
    write_baseline(tmp_path, "rare_mutation", "neat", PAPER["neat"])
    table, sources, _ = comparisons(["worked_example", "rare_mutation"], SCREENING, tmp_path)
    assert len(sources) == 6, "each record once"
    assert ranking(table, 3)["reading"].unique().tolist() == ["rare_mutation"]


def test_without_runs_there_is_nothing_to_rank(tmp_path: Path) -> None:
    table, sources, core_hours = comparisons(["worked_example", "removal"], SCREENING, tmp_path)
    assert (len(table), len(sources), core_hours) == (16, 0, 0.0)
    assert not table["compatible"].any()
    assert ranking(table, 3).empty


def test_a_record_of_another_reading_is_refused(tmp_path: Path) -> None:
    write_baseline(tmp_path, "removal", "neat", PAPER["neat"])
    (there, *_), (here, *_) = (
        [tmp_path / each.record for each in baseline_blocks(*of)]
        for of in (("removal", "neat", SCREENING), ("worked_example", "neat", SCREENING))
    )
    here.parent.mkdir(parents=True)
    there.rename(here)
    line = refusal(comparisons, ["worked_example"], SCREENING, tmp_path)
    assert "of another specification: neat.remove_connection_rate is 0.5 there and 0.0" in line


@pytest.mark.parametrize(
    ("nearest", "chosen"),
    [
        ("abcde", ["a", "b", "c", "worked_example"]),
        (["a", "worked_example", "b", "c", "d"], ["a", "worked_example", "b", "c"]),
        (["a", "b", "c", "worked_example"], ["a", "b", "c", "worked_example"]),
        (["a"], ["a", "worked_example"]),
        ([], ["worked_example"]),
    ],
)
def test_the_three_nearest_and_the_worked_example_are_confirmed(
    nearest: list[str], chosen: list[str]
) -> None:
    ranked = pd.DataFrame({"reading": [name for name in nearest for _ in range(2)]}, dtype=object)
    assert to_confirm(ranked, "worked_example") == chosen


def test_a_record_that_lacks_its_seed_is_refused(tmp_path: Path) -> None:
    write_baseline(tmp_path, "worked_example", "neat", PAPER["neat"])
    one, other, _ = (
        tmp_path / each.record for each in baseline_blocks("worked_example", "neat", SCREENING)
    )
    other.write_bytes(one.read_bytes())
    with pytest.raises(UserError, match="does not hold the seeds that its name says"):
        comparisons(["worked_example"], SCREENING, tmp_path)
