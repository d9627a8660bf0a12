"""Tests of a grid's cells on made-up runs."""

from typing import ClassVar

import numpy as np
import pytest

from tests.helpers.claimed import (
    Test,
    Values,
    around,
    cell,
    decision,
    verdict,
)


class TestLevel:
    TEST: ClassVar[Test] = {"kind": "level", "bound": "at_least", "level": 500, "methods": ["bcm"]}
    GRID: ClassVar[Values] = {
        cell("bcm", p, rate): [500.0] * 8 for p in (6, 12) for rate in (0.1, 0.2)
    }

    def test_every_cell_must_reach_it(self) -> None:
        assert verdict(self.GRID, **self.TEST) == "supported"
        lower = self.GRID | {cell("bcm", 6, 0.2): around(490)}
        assert verdict(lower, **self.TEST) == "contradicted"
        assert verdict(lower, **self.TEST, where={"populations": ["largest"]}) == "supported"

    def test_more_generations_could_still_reach_it(self) -> None:
        lower = self.GRID | {cell("bcm", 6, 0.2): around(490)}
        (reason,) = {f.reason for f in decision(lower, **self.TEST, generations=100).findings} - {
            ""
        }
        assert reason == "fewer than 500 generations"

    def test_below(self) -> None:
        lower = self.GRID | {cell("bcm", 6, 0.2): around(490)}
        test = self.TEST | {"bound": "below"}
        there = {"populations": ["smallest"], "learning_rates": ["largest"]}
        assert verdict(lower, **test, where=there) == "supported"
        assert verdict(self.GRID, **test, where=there) == "contradicted"

    def test_one_run_below_the_maximum_is_enough(self) -> None:
        """Its interval would still reach 500."""
        low = self.GRID | {cell("bcm", 6, 0.2): [500.0] * 7 + [499.0]}
        test = self.TEST | {"maximum": True}
        assert verdict(low, **self.TEST) == "undecided"
        assert verdict(low, **test) == "contradicted"
        below = test | {"where": {"populations": ["smallest"], "learning_rates": ["largest"]}}
        below |= {"bound": "below"}
        assert verdict(low, **below) == "supported"
        for each in (test, below):
            assert verdict(low, **each, generations=100) == "undecided"

    def test_the_maximum_is_reached_by_as_many_seeds_as_the_papers(self) -> None:
        test = self.TEST | {"maximum": True}
        assert verdict(self.GRID, **test) == "undecided"
        more = {each: [500.0] * 30 for each in self.GRID}
        assert verdict(more, **test, seeds=30) == "supported"
        assert verdict(more, **(test | {"bound": "below"}), seeds=30) == "contradicted"

    def test_a_place_that_the_grid_lacks(self) -> None:
        for where in ({"populations": [300]}, {"populations": [6, 300]}, {"learning_rates": [0.3]}):
            (finding,) = decision(self.GRID, **self.TEST, where=where).findings
            assert (finding.verdict, finding.reason) == ("undecided", "no such cell here")


class TestShare:
    TEST: ClassVar[Test] = {
        "kind": "share",
        "direction": "higher",
        "methods": ["bcm"],
        "against": "neat",
    }
    VALUES: ClassVar[Values] = {
        **{cell("bcm", 6, rate): around(mean) for rate, mean in ((0.1, 10), (0.2, 20))},
        **{cell("bcm", 12, rate): around(mean) for rate, mean in ((0.1, 30), (0.2, 40))},
        cell("neat", 6): around(0),
        cell("neat", 12): around(35),
    }

    def test_each_cell_meets_its_own_population(self) -> None:
        """Three of four cells win; against the other population's NEAT two or four would."""
        (finding,) = decision(self.VALUES, **self.TEST, more_than=0.5).findings
        assert finding.effect == 0.25
        assert finding.verdict == "supported"
        assert verdict(self.VALUES, **self.TEST, more_than=0.9) == "contradicted"

    def test_a_lead_that_all_cells_have_is_not_contradicted_by_noise(self) -> None:
        """Some trail by chance, so fewer than nine of ten lead; but none trails surely."""
        random = np.random.default_rng(0)
        values = {
            cell("bcm", p, rate / 10): random.normal(0.1, 1, 20).tolist()
            for p in (6, 12)
            for rate in range(1, 9)
        } | {cell("neat", p): random.normal(0, 1, 20).tolist() for p in (6, 12)}
        (finding,) = decision(values, **self.TEST, more_than=0.9, seeds=20).findings
        assert finding.effect < 0
        assert finding.verdict == "undecided"
        assert finding.high == pytest.approx(0.1)

    def test_its_interval_counts_the_cells_that_surely_lead_or_trail(self) -> None:
        values = self.VALUES | {cell("bcm", 12, 0.2): around(35.1)}
        (finding,) = decision(values, **self.TEST, more_than=0.2).findings
        assert (finding.effect, finding.low, finding.high) == pytest.approx((0.55, 0.3, 0.55))
        assert finding.verdict == "supported"
        assert finding.needed == 5

    def test_rates_meet_rates(self) -> None:
        oja = {cell("oja", p, rate): around(25) for p in (6, 12) for rate in (0.1, 0.2)}
        test = self.TEST | {"against": "oja", "direction": "lower", "more_than": 0.4}
        assert decision(self.VALUES | oja, **test).findings[0].effect == pytest.approx(0.1)


class TestTrend:
    VALUES: ClassVar[Values] = {
        cell("bcm", p, rate): around(100 * rate + p) for rate in (0.1, 0.2) for p in (6, 12, 18)
    }

    @pytest.mark.parametrize("along", ["population", "learning_rate"])
    def test_up(self, along: str) -> None:
        test = {"kind": "trend", "along": along, "methods": ["bcm"]}
        (finding,) = decision(self.VALUES, **test, direction="up").findings
        assert finding.effect == 0.5  # every run beats every run below it
        assert finding.verdict == "supported"
        assert verdict(self.VALUES, **test, direction="down") == "contradicted"

    @pytest.mark.parametrize("metric", ["equal_evaluations", "equal_steps", "score"])
    def test_at_equal_cost_and_in_score_more_generations_could_turn_it_round(
        self, metric: str
    ) -> None:
        down = {cell("bcm", p): around(-10 * p) for p in (6, 12)}
        test = {"kind": "trend", "along": "population", "direction": "up", "methods": ["bcm"]}
        assert verdict(down, **test, metric=metric) == "contradicted"
        (finding,) = decision(down, **test, metric=metric, generations=100).findings
        assert (finding.verdict, finding.reason) == ("undecided", "fewer than 500 generations")
        assert verdict(down, **test, generations=100) == "contradicted"

    def test_along_the_rate_score_has_no_such_factor(self) -> None:
        down = {cell("bcm", 6, rate): around(-100 * rate) for rate in (0.1, 0.2)}
        test = {"kind": "trend", "along": "learning_rate", "direction": "up", "methods": ["bcm"]}
        assert verdict(down, **test, metric="score", generations=100) == "contradicted"

    def test_the_other_axis_is_held_fixed(self) -> None:
        """The population decides everything, so the rate nothing."""
        values = {cell("bcm", p, rate): around(10 * p) for p in (6, 12) for rate in (0.1, 0.2)}
        test = {"kind": "trend", "along": "learning_rate", "direction": "up", "methods": ["bcm"]}
        assert decision(values, **test).findings[0].effect == 0

    def test_a_method_without_rates(self) -> None:
        values = {cell("neat", p): around(p * 10) for p in (6, 12)}
        test = {"kind": "trend", "direction": "up", "methods": ["neat"]}
        assert verdict(values, **test, along="population") == "supported"
        assert verdict(values, **test, along="learning_rate") == "undecided"


class TestPeak:
    VALUES: ClassVar[Values] = {
        cell("bcm", 6, 0.1): around(10),
        cell("bcm", 6, 0.2): around(20),
        cell("bcm", 12, 0.1): around(30),
        cell("bcm", 12, 0.2): around(5),
        cell("neat", 6): around(22),
        cell("neat", 12): around(1),
    }
    TEST: ClassVar[Test] = {"kind": "peak", "methods": ["bcm"]}

    def test_within_the_method(self) -> None:
        (finding,) = decision(self.VALUES, **self.TEST, where={"populations": ["largest"]}).findings
        assert finding.effect == 10
        assert finding.verdict == "supported"
        assert verdict(self.VALUES, **self.TEST, where={"learning_rates": [0.2]}) == "contradicted"

    @pytest.mark.parametrize(
        ("where", "at_first"),
        [({"populations": ["largest"]}, "undecided"), ({"learning_rates": [0.2]}, "contradicted")],
    )
    def test_a_peak_of_score_at_a_size_may_come_later(self, where: Test, at_first: str) -> None:
        below = {cell("bcm", p, r): around(-p * (1 + 10 * r)) for p in (6, 12) for r in (0.1, 0.2)}
        test = self.TEST | {"metric": "score", "where": where}
        assert verdict(below, **test) == "contradicted"
        assert verdict(below, **test, generations=100) == at_first

    def test_against_another_method_with_a_margin(self) -> None:
        test = self.TEST | {"against": ["neat"]}
        assert decision(self.VALUES, **test).findings[0].effect == 8
        assert verdict(self.VALUES, **test, margin=4) == "supported"
        assert verdict(self.VALUES, **test, margin=12) == "contradicted"

    def test_more_generations_could_still_bring_the_margin(self) -> None:
        test = self.TEST | {"against": ["neat"], "generations": 100}
        (finding,) = decision(self.VALUES, **test, margin=12).findings
        assert (finding.verdict, finding.reason) == ("undecided", "fewer than 500 generations")
        assert verdict(self.VALUES, **test, margin=4) == "supported"
        assert verdict(self.VALUES, **self.TEST, where={"learning_rates": [0.2]}) == "contradicted"

    @pytest.mark.slow
    @pytest.mark.parametrize("inside", ["one cell", "all but one"])
    def test_where_nothing_differs_noise_seldom_decides(self, inside: str) -> None:
        """Of many noisy cells one is always the highest; that must count neither way."""
        random = np.random.default_rng(0)
        rates = [0.1 * (1 + number) for number in range(12)]
        there = rates[:1] if inside == "one cell" else rates[1:]
        test = self.TEST | {"where": {"learning_rates": there}}
        verdicts = [
            verdict(
                {cell("bcm", 6, rate): random.normal(size=20) for rate in rates}, **test, seeds=20
            )
            for _ in range(40)
        ]
        assert verdicts.count("undecided") >= 37

    def test_intermediate_rates_need_others_below_and_above(self) -> None:
        rates = {0.1: 5, 0.2: 20, 0.3: 10}
        values = {cell("bcm", 6, rate): around(mean) for rate, mean in rates.items()}
        test = self.TEST | {"where": {"learning_rates": [0.2]}, "intermediate": True}
        assert verdict(values, **test) == "supported"
        for rate in (0.1, 0.3):
            fewer = {each: runs for each, runs in values.items() if each.learning_rate != rate}
            assert decision(fewer, **test).findings[0].reason == "no such cell here"


def test_sensitivity() -> None:
    """Ranges over the rates: 10 and 20 for Hebb, 1 and 3 for BCM."""
    means = {"hebb": {6: (0, 10), 12: (5, 25)}, "bcm": {6: (7, 8), 12: (4, 1)}}
    values = {
        cell(method, p, rate): around(mean)
        for method, rows in means.items()
        for p, row in rows.items()
        for rate, mean in zip((0.1, 0.2), row, strict=True)
    }
    test = {"kind": "sensitivity", "method": "hebb", "than": ["bcm"]}
    assert decision(values, **test).findings[0].effect == 15 - 2
    assert verdict(values, **test) == "supported"
    assert verdict(values, **(test | {"method": "bcm", "than": ["hebb"]})) == "contradicted"
