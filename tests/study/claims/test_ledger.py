"""The ledger as a table, a page and LaTeX."""

import math
from dataclasses import replace
from functools import cache

import pytest

from neol.study.claims.answers import Answer, answers
from neol.study.claims.calibration import made_up_studies
from neol.study.claims.ledger import (
    as_latex,
    as_markdown,
    as_table,
    count_words,
    seeds_and_level,
)
from neol.study.claims.looks import LOOKS, level
from neol.study.claims.questions import load_claims, load_questions
from neol.study.claims.units import in_print, unit_of


@cache
def found() -> tuple[Answer, ...]:
    """A study in which the paper's tables are true."""
    return answers(load_questions(), next(made_up_studies("paper")))


def test_a_question_has_one_row_and_one_for_each_part() -> None:
    table = as_table(found())
    whole = table[table["part"] == "all"].set_index("question")
    assert list(whole.index) == [question.id for question in load_questions()]
    parts = table[(table["question"] == "final-neat-hopper") & (table["part"] != "all")]
    assert list(parts["part"]) == ["hopper: bcm", "hopper: hebb", "hopper: oja"]
    lander = whole.loc["final-neat-lunar-lander"]
    assert lander["verdict"] == "reproduced"
    assert lander["paper_effect"] == pytest.approx((324.34 + 323.35 + 323.53) / 3 - 311.77)
    assert (lander["for"], lander["against"], lander["open"]) == (3, 0, 0)
    assert whole.loc["continuous-standardised", "papers_verdict"] == "not shown"
    assert math.isnan(whole.loc["whole-grid", "paper_effect"])


def test_the_page_has_each_question_with_its_sentences() -> None:
    text = as_markdown(found(), load_claims(), "Budget made up.")
    assert f"{len(load_claims())} sentences of the paper raise 36 questions" in text
    section = text.split("## competitive: reproduced")[1].split("\n## ")[0]
    assert "> NEOL methods are competitive with standard NEAT" in section
    assert section.count("\n| lunar_lander: ") == 3
    for answer in found():
        link = f"(#{answer.question.id}-{answer.verdict.replace(' ', '-')})"
        assert link in text
        assert f"## {answer.question.id}: {answer.verdict}" in text
    assert "nan" not in text.replace("nance", "")


def test_latex_has_a_row_for_each_question() -> None:
    text = as_latex(found(), "Budget made up.")
    rows = text.split("\\endhead")[1].split("\\bottomrule")[0].strip().splitlines()
    assert len(rows) == len(found())
    assert all(row.count(" & ") == 7 and row.endswith(r" \\") for row in rows)


def test_seeds_needed_are_stated_where_more_seeds_would_help() -> None:
    (hopper,) = [each for each in found() if each.question.id == "final-neat-hopper"]
    open_ = replace(hopper, verdict="inconclusive", seeds_needed=83.0)
    text = as_markdown([open_], load_claims(), "")
    assert "Detecting the paper's effect takes about 83 seeds." in text


def test_verdicts_are_counted() -> None:
    one, two, three = found()[:3]
    some = [
        replace(one, verdict="mixed"),
        replace(two, verdict="mixed"),
        replace(three, verdict="too short"),
    ]
    assert count_words(some) == "2 mixed, 1 too short"


@pytest.mark.parametrize(
    ("question", "unit", "printed"),
    [
        ("final-neat-hopper", "return", 0.5),
        ("score-neat-hopper", "SCORE", 0.5),
        ("spread-neat-hopper", "ratio of SDs", math.exp(0.5)),
        ("competitive", "SDs of a run", 0.5),
        ("continuous-relative", "share of the baseline's mean", 0.5),
        ("two-by-two", "SDs of a run", 0.5),
        ("cartpole-ceiling", "", 0.5),
    ],
)
def test_effects_have_the_unit_in_which_they_are_computed(
    question: str, unit: str, printed: float
) -> None:
    (asked,) = (each for each in load_questions() if each.id == question)
    assert unit_of(asked) == unit
    assert in_print(asked, 0.5) == (printed,)


def test_seeds_stand_beside_the_coverage_of_their_interval() -> None:
    assert [seeds_and_level(n, 1 - level(place)) for place, n in enumerate(LOOKS)] == [
        "10 (99.98%)", "20 (98.8%)", "30 (95.37%)",
    ]  # fmt: skip
    assert seeds_and_level(0, 0.95) == "--"


def test_more_than_ten_seeds_are_also_shown_without_the_first_ten() -> None:
    whole = as_table(found()).set_index(["question", "part"]).xs("all", level="part")
    alone = whole.loc["final-neat-lunar-lander", ["fresh_low", "fresh_effect", "fresh_high"]]
    assert alone.is_monotonic_increasing and alone.notna().all()
