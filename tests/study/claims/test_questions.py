"""paper/questions.yaml and paper/claims.yaml."""

from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.spec.configuration import ROOT
from neol.study.claims.questions import CLAIMS, QUESTIONS, load_claims, load_questions


def test_every_question_is_raised_by_a_sentence_of_the_paper() -> None:
    raised = {name for claim in load_claims() for name in claim.questions}
    assert raised == {question.id for question in load_questions()}


def test_main_questions_are_three_outcomes_by_two_baselines_by_three_tasks() -> None:
    main = [each for each in load_questions() if each.family in ("fitness", "SCORE", "spread")]
    assert len(main) == 3 * 2 * 3
    assert {each.tasks for each in main} == {("lunar_lander",), ("hopper",), ("bipedal_walker",)}


def test_no_sentence_is_quoted_twice() -> None:
    quotes = [claim.quote for claim in load_claims()]
    assert len(set(quotes)) == len(quotes)


def with_line(path: Path, old: str, new: str, to: Path) -> Path:
    text = path.read_text(encoding="utf-8")
    assert old in text
    changed = to / path.name
    changed.write_text(text.replace(old, new, 1), encoding="utf-8")
    return changed


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("expect: higher", "expect: above", "questions.0.difference.expect: Input should be"),
        ("kind: ceiling", "kind: floor", "questions.18: Input tag 'floor' found"),
        ("share: 0.9", "share: 1.9", "questions.18.ceiling.share: Input should be less than 1"),
        ("id: final-neat-hopper", "id: final-neat-lunar-lander", 'two entries are called "final-'),
        ("cells: table3", "cells: table9", "questions.0.difference.side.cells: Input should be"),
    ],
)
def test_a_wrong_question_is_said_in_one_line(
    old: str, new: str, said: str, tmp_path: Path
) -> None:
    with pytest.raises(UserError) as error:
        load_questions(with_line(QUESTIONS, old, new, tmp_path))
    assert str(error.value).startswith("questions.yaml: ")
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_claim_of_no_question_is_said(tmp_path: Path) -> None:
    changed = with_line(CLAIMS, "[cartpole-ceiling]", "[cartpole-floor]", tmp_path)
    with pytest.raises(UserError, match='cartpole-converges: there is no question "cartpole-floor'):
        load_claims(changed)


def test_both_files_lie_in_the_paper_s_folder() -> None:
    assert {CLAIMS.parent, QUESTIONS.parent} == {ROOT / "paper"}
