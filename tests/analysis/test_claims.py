"""Each kind of test on made-up runs whose answer is known, and the ledger itself."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pandas as pd
import pytest
import yaml

from neol.analysis.claims import CLAIMS, Claim, Decision, decide, load_claims
from neol.analysis.ledger import as_latex, as_markdown, as_table
from neol.analysis.outcomes import METRICS, Outcomes
from neol.analysis.statistics import seeds_needed
from neol.campaign import Cell
from neol.errors import UserError
from neol.spec import load_configuration

Values = dict[Cell, Sequence[float]]
Test = dict[str, Any]
NOISE = (-2.0, -1.0, -0.5, 0.0, 0.0, 0.5, 1.0, 2.0)
"""Eight seeds around their mean."""


def cell(method: str, population: int = 6, rate: float | None = 0.1, task: str = "hopper") -> Cell:
    return Cell(task, method, population, None if method.startswith("neat") else rate)


def around(mean: float, factor: float = 1.0) -> list[float]:
    return [mean + factor * each for each in NOISE]


def outcomes(values: Values, seeds: int = 8, generations: int | dict[str, int] = 500) -> Outcomes:
    """All metrics have the same values; every setting chooses among a method's cells."""
    rows = [
        (each.task, each.method, each.population, each.learning_rate, seed, *[value] * len(METRICS))
        for each, runs in values.items()
        for seed, value in enumerate(runs)
    ]
    columns = ["task", "method", "population", "learning_rate", "seed", *METRICS]
    candidates: dict[tuple[str, str], list[Cell]] = {}
    for each in values:
        candidates.setdefault((each.task, each.method), []).append(each)
    return Outcomes(
        pd.DataFrame(rows, columns=columns).astype({"learning_rate": float}),
        tuple(values),
        dict.fromkeys(("table3", "table4", "score"), candidates),
        load_configuration("paper").budget.model_copy(
            update={"seeds": seeds, "generations": generations}
        ),
    )


def claim(**test: Any) -> Claim:
    test = {"metric": "final_best", "tasks": ["hopper"]} | test
    if test["kind"] in ("compare", "significant", "not_significant", "rank", "larger_gain"):
        test = {"setting": "table3"} | test
    content = yaml.safe_dump({"id": "made-up", "place": "here", "quote": "...", "tests": [test]})
    return Claim.model_validate(yaml.safe_load(content), strict=False)


def decision(
    values: Values, *, seeds: int = 8, generations: int | dict[str, int] = 500, **test: Any
) -> Decision:
    return decide(claim(**test), outcomes(values, seeds, generations))


def verdict(values: Values, **test: Any) -> str:
    return decision(values, **test).verdict


HIGHER: Test = {
    "kind": "compare",
    "statistic": "mean",
    "direction": "higher",
    "methods": ["bcm"],
    "against": "neat",
}


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


class TestWhatCannotBeDecided:
    def test_a_cell_that_the_budget_lacks(self) -> None:
        (finding,) = decision({cell("bcm"): around(10)}, **HIGHER).findings
        assert (finding.verdict, finding.reason) == ("undecided", "not in this budget")

    def test_missing_seeds(self) -> None:
        values = {cell("bcm"): around(10)[1:], cell("neat"): around(5)}
        (finding,) = decision(values, **HIGHER).findings
        assert (finding.verdict, finding.reason) == ("undecided", "seeds are missing")
        assert finding.effect == pytest.approx(10 + 2 / 7 - 5)

    def test_a_candidate_that_lacks_seeds_could_have_been_chosen(self) -> None:
        values = {
            cell("bcm"): around(10),
            cell("bcm", rate=0.2): around(99)[1:],
            cell("neat"): around(5),
        }
        tests = (
            HIGHER,
            {"kind": "significant", "methods": ["bcm"], "against": "neat"},
            {"kind": "rank", "at_most": 1, "method": "bcm", "among": ["bcm", "neat"]},
            {"kind": "level", "bound": "at_least", "level": 1, "methods": ["bcm"]}
            | {"setting": "table3"},
        )
        for test in tests:
            (finding,) = decision(values, **test).findings
            assert (finding.verdict, finding.reason) == ("undecided", "seeds are missing")
        values[cell("bcm")] = around(10)[1:]  # now none is complete, so none is chosen
        assert decision(values, **HIGHER).findings[0].reason == "seeds are missing"

    @pytest.mark.parametrize("seeds", [0, 1, 2, 4])
    def test_too_few_seeds(self, seeds: int) -> None:
        values = {cell("bcm"): around(10)[:seeds], cell("neat"): around(5)[:seeds]}
        assert verdict(values, **HIGHER, seeds=seeds) == "undecided"

    def test_a_run_without_a_value(self) -> None:
        values = {cell("bcm"): [math.nan, *around(10)[1:]], cell("neat"): around(5)}
        assert decision(values, **HIGHER).findings[0].reason == "a run has no value"


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
        assert verdict(self.GRID, **test) == "supported"
        there = {"populations": ["smallest"], "learning_rates": ["largest"]}
        assert verdict(low, **(test | {"bound": "below"}), where=there) == "supported"
        assert decision(low, **test, generations=100).verdict == "undecided"

    def test_a_place_that_the_grid_lacks(self) -> None:
        for where in ({"populations": [300]}, {"populations": [6, 300]}, {"learning_rates": [0.3]}):
            (finding,) = decision(self.GRID, **self.TEST, where=where).findings
            assert (finding.verdict, finding.reason) == ("undecided", "not in this budget")


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

    def test_against_another_method_with_a_margin(self) -> None:
        test = self.TEST | {"against": ["neat"]}
        assert decision(self.VALUES, **test).findings[0].effect == 8
        assert verdict(self.VALUES, **test, margin=4) == "supported"
        assert verdict(self.VALUES, **test, margin=12) == "contradicted"

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
            assert decision(fewer, **test).findings[0].reason == "not in this budget"


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


class TestLedger:
    def test_the_papers_claims_load_and_each_has_parts(self) -> None:
        claims = load_claims()
        assert len(claims) >= 25
        everywhere = outcomes(
            {
                cell(method, p, rate, task): around(p)
                for task in ("cartpole", "lunar_lander", "hopper", "bipedal_walker")
                for method in ("bcm", "hebb", "oja", "neat", "neat_wo")
                for p in (50, 200, 300)
                for rate in (2.5e-4, 2.5e-3, 2.5e-2, 2.5e-1)
            }
        )
        decisions = [decide(each, everywhere) for each in claims]
        reasons = {f.reason for each in decisions for f in each.findings}
        assert "not in this budget" not in reasons
        table = as_table(decisions)
        assert set(table["claim"]) == {each.id for each in claims}
        assert list(table[table["decisive"]]["claim"]) == [each.id for each in claims]
        page, latex = (
            as_markdown(decisions, "Budget made up."),
            as_latex(decisions, "Budget made up."),
        )
        assert page.count("\n## ") == len(claims)
        assert latex.count("{") == latex.count("}")

    def test_each_statement_of_a_sentence_has_its_test(self) -> None:
        tests = {each.id: each.tests for each in load_claims()}
        assert {(test.setting, test.against) for test in tests["recover-and-surpass"]} == {
            ("table4", "neat_wo")
        }
        assert [test.statistic for test in tests["neat-struggles"]] == ["sd", "low_outliers"]
        assert [test.kind for test in tests["score-cartpole-population"]] == [
            "level", "level", "trend",
        ]  # fmt: skip

    def test_a_verdict_does_not_depend_on_other_claims_or_the_order_of_runs(self) -> None:
        values = {cell("bcm"): around(10), cell("neat"): around(8)}
        data = outcomes(values)
        shuffled = Outcomes(
            data.runs.sample(frac=1, random_state=np.random.default_rng(0)),
            data.cells,
            data.candidates,
            data.budget,
        )
        first, second = (decide(claim(**HIGHER), each).findings[0] for each in (data, shuffled))
        assert (first.low, first.high) == (second.low, second.high)
        other = claim(**HIGHER).model_copy(update={"id": "other"})
        for order in ((claim(**HIGHER), other), (other, claim(**HIGHER))):
            found = {each.id: decide(each, data).findings[0] for each in order}
            assert (found["made-up"].low, found["made-up"].high) == (first.low, first.high)
            assert found["other"].low != first.low  # a bootstrap of its own

    def test_what_is_wrong_in_the_file_is_said_in_one_line(self, tmp_path: Path) -> None:
        path = tmp_path / "claims.yaml"
        text = CLAIMS.read_text()
        path.write_text(text.replace("kind: rank", "kind: rnak", 1))
        with pytest.raises(UserError, match=r"claims\.yaml: claims\.\d+\.tests\.\d+.*rnak"):
            load_claims(path)
        path.write_text(text.replace("id: table-5", "id: significant", 1))
        with pytest.raises(UserError, match='two claims are called "significant"'):
            load_claims(path)
