"""What decides a claim, and the paper's claims."""

import math
from pathlib import Path

import numpy as np
import pytest

from neol.base.errors import UserError
from neol.study.claims.claims import CLAIMS, decide, load_claims
from neol.study.claims.ledger import as_latex, as_markdown, as_table
from neol.study.outcomes.outcomes import Outcomes
from tests.helpers.claimed import (
    HIGHER,
    around,
    cell,
    claim,
    decision,
    outcomes,
    verdict,
)


class TestWhatCannotBeDecided:
    def test_a_cell_that_the_budget_lacks(self) -> None:
        (finding,) = decision({cell("bcm"): around(10)}, **HIGHER).findings
        assert (finding.verdict, finding.reason) == ("undecided", "no such cell here")

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


class TestLedger:
    @pytest.mark.slow
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
        assert "no such cell here" not in reasons
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
            for finding in found.values():
                assert (finding.low, finding.high) == (first.low, first.high)

    def test_what_is_wrong_in_the_file_is_said_in_one_line(self, tmp_path: Path) -> None:
        path = tmp_path / "claims.yaml"
        text = CLAIMS.read_text()
        path.write_text(text.replace("kind: rank", "kind: rnak", 1))
        with pytest.raises(UserError, match=r"claims\.yaml: claims\.\d+\.tests\.\d+.*rnak"):
            load_claims(path)
        path.write_text(text.replace("id: table-5", "id: significant", 1))
        with pytest.raises(UserError, match='two claims are called "significant"'):
            load_claims(path)
