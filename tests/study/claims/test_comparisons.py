"""Tests of one cell against another on made-up runs."""

import math
from typing import ClassVar

import pytest

from neol.study.outcomes.statistics import seeds_needed
from tests.helpers.claimed import (
    HIGHER,
    Test,
    Values,
    around,
    cell,
    decision,
    verdict,
)


class TestCompare:
    def test_mean(self) -> None:
        better = {cell("bcm"): around(10), cell("neat"): around(5)}
        (finding,) = decision(better, **HIGHER).findings
        assert finding.verdict == "supported"
        assert finding.effect == 5
        assert 0 < finding.low < 5 < finding.high
        assert finding.seeds == 8
        assert (
            verdict({cell("bcm"): around(5), cell("neat"): around(10)}, **HIGHER) == "contradicted"
        )
        assert verdict({cell("bcm"): around(5.1), cell("neat"): around(5)}, **HIGHER) == "undecided"
        assert verdict(better, **(HIGHER | {"direction": "lower"})) == "contradicted"

    def test_equal_is_not_higher(self) -> None:
        assert (
            verdict({cell("bcm"): [500.0] * 8, cell("neat"): [500.0] * 8}, **HIGHER)
            == "contradicted"
        )

    @pytest.mark.parametrize("statistic", ["sd", "iqr"])
    def test_spread(self, statistic: str) -> None:
        tight = {cell("bcm"): around(10, 0.1), cell("neat"): around(10, 10)}
        test = HIGHER | {"statistic": statistic, "direction": "lower"}
        assert verdict(tight, **test) == "supported"
        assert verdict(tight, **(test | {"direction": "higher"})) == "contradicted"

    def test_median_is_not_the_mean(self) -> None:
        values = {cell("bcm"): [9.0] * 7 + [-999.0], cell("neat"): [5.0] * 8}
        assert decision(values, **(HIGHER | {"statistic": "median"})).findings[0].effect == 4
        assert decision(values, **HIGHER).findings[0].effect < 0

    def test_low_outliers(self) -> None:
        values = {cell("bcm"): [9.0] * 8, cell("neat"): [1.0, 1.0, *[9.0] * 6]}
        test = HIGHER | {"statistic": "low_outliers", "direction": "lower"}
        assert decision(values, **test).findings[0].effect == 0.25

    def test_all_parts_must_hold_and_one_contradicts(self) -> None:
        values = {cell("bcm"): around(10), cell("oja"): around(5.1), cell("neat"): around(5)}
        both = HIGHER | {"methods": ["bcm", "oja"]}
        assert decision(values, **both).supported == 1
        assert verdict(values, **both) == "undecided"
        assert verdict(values | {cell("oja"): around(0)}, **both) == "contradicted"


class TestSignificance:
    BETTER: ClassVar[Values] = {cell("bcm"): around(10), cell("neat"): around(5)}
    TEST: ClassVar[Test] = {"kind": "significant", "methods": ["bcm"], "against": "neat"}

    def test_significant(self) -> None:
        (finding,) = decision(self.BETTER, **self.TEST).findings
        assert finding.verdict == "supported"
        assert finding.effect == 0.5  # every run wins: A12 = 1
        assert finding.p < 0.001
        worse = {cell("bcm"): around(5), cell("neat"): around(10)}
        assert verdict(worse, **self.TEST) == "contradicted"
        assert (
            verdict({cell("bcm"): around(5), cell("neat"): around(5)}, **self.TEST) == "undecided"
        )

    def test_not_significant_needs_as_many_seeds_as_the_paper(self) -> None:
        test = self.TEST | {"kind": "not_significant"}
        assert verdict(self.BETTER, **test) == "contradicted"
        worse = {cell("bcm"): around(5) * 4, cell("neat"): around(10) * 4}
        assert verdict(worse, **test, seeds=32) == "contradicted"
        equal = [500.0] * 30
        few = {cell("bcm"): equal[:8], cell("neat"): equal[:8]}
        assert verdict(few, **test) == "undecided"
        assert verdict({cell("bcm"): equal, cell("neat"): equal}, **test, seeds=30) == "supported"


class TestSeedsNeeded:
    def test_never_fewer_than_decide_anything(self) -> None:
        values = {cell("bcm"): around(1000), cell("neat"): around(5)}
        assert decision(values, **HIGHER).findings[0].needed == 5

    def test_of_significance_it_is_the_rank_sum_tests(self) -> None:
        values = {cell("bcm"): around(1), cell("neat"): around(0)}
        (finding,) = decision(values, **TestSignificance.TEST).findings
        assert finding.needed == seeds_needed(finding.effect + 0.5)

    def test_unknown_without_spread_and_for_no_significance(self) -> None:
        equal = {cell("bcm"): [9.0] * 8, cell("neat"): [5.0] * 8}
        assert math.isnan(decision(equal, **HIGHER).findings[0].needed)
        test = TestSignificance.TEST | {"kind": "not_significant"}
        assert math.isnan(decision(TestSignificance.BETTER, **test).findings[0].needed)


class TestRank:
    VALUES: ClassVar[Values] = {
        cell("bcm"): around(30),
        cell("oja"): around(20),
        cell("neat"): around(10),
    }

    @pytest.mark.parametrize(
        ("method", "at_most", "expected"),
        [
            ("bcm", 1, "supported"),
            ("oja", 1, "contradicted"),
            ("oja", 2, "supported"),
            ("neat", 2, "contradicted"),
        ],
    )
    def test_rank(self, method: str, at_most: int, expected: str) -> None:
        among = ["bcm", "oja", "neat"]
        assert (
            verdict(self.VALUES, kind="rank", at_most=at_most, method=method, among=among)
            == expected
        )

    def test_a_shared_first_place_is_second_but_does_not_lead(self) -> None:
        values = {cell(method): [5.0] * 8 for method in ("bcm", "oja", "neat")}
        test = {"kind": "rank", "method": "oja", "among": ["bcm", "oja", "neat"]}
        assert verdict(values, **test, at_most=2) == "supported"
        assert verdict(values, **test, at_most=1) == "contradicted"


def test_larger_gain_is_relative() -> None:
    """From 100 to 120 is less than from 10 to 20, and from -20 to -10 a gain as well."""
    values = {
        cell("bcm", task="hopper"): around(20),
        cell("neat", task="hopper"): around(10),
        cell("bcm", task="cartpole"): around(120),
        cell("neat", task="cartpole"): around(100),
    }
    test = {
        "kind": "larger_gain",
        "methods": ["bcm"],
        "against": "neat",
        "than_tasks": ["cartpole"],
    }
    (finding,) = decision(values, **test).findings
    assert finding.effect == pytest.approx(1 - 0.2)
    assert finding.verdict == "supported"
    negative = {cell("bcm"): around(-10), cell("neat"): around(-20)}
    assert decision(values | negative, **test).findings[0].effect == pytest.approx(0.5 - 0.2)
    (unequal,) = decision(values, generations={"hopper": 8, "cartpole": 100}, **test).findings
    assert unequal.effect == finding.effect
    assert unequal.verdict == "undecided"
    assert unequal.reason == "tasks of different numbers of generations"
