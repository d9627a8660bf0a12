"""Rates of false and true verdicts of the whole chain: docs/explanation/verdicts.md."""

from functools import cache
from itertools import islice
from pathlib import Path

import pandas as pd
import pytest

from neol.study.claims import calibration
from neol.study.claims.calibration import (
    BEGIN,
    END,
    PAGE,
    TRUTHS,
    frequencies,
    made_up_studies,
    write_section,
)
from neol.study.claims.kinds import evidence
from neol.study.claims.questions import load_questions
from neol.study.claims.sides import Runs
from neol.study.outcomes.statistics import ALPHA

STUDIES = 25
"""Number of studies; a share of 0.05 gives more than 5 of them with a probability of 0.001."""
TOO_MANY = 6 / STUDIES
(SENSITIVITY,) = (each for each in load_questions() if each.kind == "sensitivity")
NO_EFFECT = ["competitive", "cartpole-ceiling", "cartpole-score-neat", "cartpole-score-neat-wo"]
"""Questions that the world without any effect answers as the paper does."""


@cache
def rates(truth: str) -> pd.DataFrame:
    return frequencies(truth, STUDIES, seed=1).set_index("question")


@pytest.mark.slow
def test_where_nothing_is_true_little_is_supported() -> None:
    support = rates("null")["support"].drop(NO_EFFECT)
    assert support.max() < TOO_MANY
    assert support.mean() < 0.02


@pytest.mark.slow
def test_an_effect_of_one_deviation_is_found_and_never_denied() -> None:
    found = rates("shift")
    for name in (
        "final-neat-hopper",
        "final-neat-wo-hopper",
        "final-neat-bipedal-walker",
        "whole-grid",
    ):
        assert found.loc[name, "support"] > 0.8
        assert found.loc[name, "contradiction"] < TOO_MANY
    assert found.loc[["larger-populations", "walker-rates"], "support"].max() < TOO_MANY


@pytest.mark.slow
def test_one_good_rule_is_no_ridge_over_rates_or_populations() -> None:
    found = rates("one better")
    assert (
        found.loc[["larger-populations", "hopper-rates", "walker-rates"], "support"].max()
        < TOO_MANY
    )


@pytest.mark.slow
def test_rates_that_matter_alike_are_no_greater_sensitivity_of_one_rule() -> None:
    """Two comparisons share the rule, whose error counts once."""
    supported = 0
    for study in islice(made_up_studies("rates", seed=3), 200):
        found = evidence(SENSITIVITY, Runs(study, 0, 30), ALPHA).whole
        assert found and found.ours
        supported += found.ours.p() < ALPHA
    assert supported < 18  # 11 of these studies; 23 if the rule's error counted twice


@pytest.mark.slow
def test_a_faithful_reproduction_can_pass() -> None:
    """The paper's tables are the truth; the old ledger passed nine parts with 0.025."""
    found = rates("paper")
    shown = found[found["papers"] == "reproduced"]
    assert (shown["contradiction"] < TOO_MANY).all()
    sure = ["final-neat-lunar-lander", "final-neat-wo-lunar-lander", "score-neat-lunar-lander",
            "score-neat-wo-lunar-lander", "competitive"]  # fmt: skip
    assert (shown.loc[sure, "reproduced"] > 0.85).all()
    assert shown["support"].mean() > 0.6


def test_the_page_tells_of_every_question() -> None:
    section = PAGE.read_text(encoding="utf-8").split(BEGIN)[1].split(END)[0]
    for question in load_questions():
        if question.by_construction is None and question.id != "two-by-two":
            assert f"| `{question.id}` |" in section
    assert all(f"- **{truth}**: " in section for truth in TRUTHS)


def test_only_the_generated_part_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(calibration, "section", lambda studies: f"{studies} studies.\n")
    page = tmp_path / "page.md"
    page.write_text(f"Before.\n{BEGIN}old\n{END}After.\n")
    write_section(7, page)
    assert page.read_text() == f"Before.\n{BEGIN}7 studies.\n{END}After.\n"
