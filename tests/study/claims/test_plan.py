"""The plan and the questions are those that were frozen."""

from pathlib import Path

from neol.study.claims.plan import FROZEN, LATER_CHANGES, PLAN, digests, frozen_plan, plan_digest
from neol.study.claims.questions import load_claims, load_questions


def test_the_frozen_files_are_as_they_were() -> None:
    """After a change `python -m neol.study.claims.plan` prints what frozen.txt must hold.

    The plan lists the change, its reason and what it changed.
    """
    assert FROZEN.read_text(encoding="utf-8") == digests()


def test_only_later_changes_may_be_added(tmp_path: Path) -> None:
    text = PLAN.read_text(encoding="utf-8")
    changed = tmp_path / "plan.md"
    changed.write_text(f"{text}\n- A later change.\n", encoding="utf-8")
    assert plan_digest(changed) == plan_digest()
    changed.write_text(text.replace("0.0120", "0.05"), encoding="utf-8")
    assert plan_digest(changed) != plan_digest()
    assert text.count(f"\n{LATER_CHANGES}\n") == 1


def test_the_plan_counts_what_there_is() -> None:
    text, questions = PLAN.read_text(encoding="utf-8"), load_questions()
    assert f"`paper/questions.yaml` has {len(questions)} questions" in text
    assert f"quotes {len(load_claims())} sentences" in text
    for family, name in (("fitness", "final fitness"), ("SCORE", "SCORE"), ("spread", "spread")):
        size = sum(question.family == family for question in questions)
        assert f"{name} ({size})" in text
    assert f"patterns ({sum(each.family == 'patterns' for each in questions)}:" in text


def test_pages_name_the_plan() -> None:
    assert frozen_plan().startswith(f"Plan: `paper/plan.md`, SHA-256 `{plan_digest()[:16]}`, ")
