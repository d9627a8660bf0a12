"""The ledger as a table, a page and LaTeX."""

import math
from dataclasses import replace
from functools import cache

import pytest

from neol.study.claims.answers import Answer, answers
from neol.study.claims.calibration import made_up_studies
from neol.study.claims.ledger import as_latex, as_markdown, as_table, count_words
from neol.study.claims.questions import load_claims, load_questions


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
    assert all(row.count(" & ") == 6 and row.endswith(r" \\") for row in rows)


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
