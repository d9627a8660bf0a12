"""What a budget says in short: counts and names of what its tables hold, and no more."""

from typing import Any

import pandas as pd

from neol.study.claims.questions import load_questions
from neol.study.outcomes.effects import FITNESS, SCORE
from neol.study.report import in_short


def effects(*rows: dict[str, Any]) -> pd.DataFrame:
    """Comparisons on Hopper, by default of BCM with NEAT, not distinguishable."""
    usual = {
        "outcome": FITNESS, "task": "hopper", "method": "bcm", "against": "neat", "seeds": 10,
        "difference": 1.0, "low": -1.0, "high": 3.0, "p_holm": 1.0, "near_control": False,
    }  # fmt: skip
    return pd.DataFrame([usual | row for row in rows])


HIGHER = {"low": 0.5, "p_holm": 0.01}
NOT_CORRECTED = (
    "They are not corrected for earlier looks at fewer seeds, nor SCORE's for the choice of the "
    "best learning rate."
)


def test_questions_are_counted_by_verdict_and_answers_named() -> None:
    """Parts are not counted, nor questions that the budget cannot ask."""
    a, b, c, d, *_, main = reversed(load_questions())
    rows = [
        (main.id, "all", "not reproduced", False),
        (a.id, "all", "reproduced", True), (a.id, "hopper: bcm", "reproduced", True),
        (b.id, "all", "too short", False), (c.id, "all", "not reproduced", False),
        (d.id, "all", "not asked here", False),
    ]  # fmt: skip
    ledger = pd.DataFrame(rows, columns=["question", "part", "verdict", "near_control"])
    assert in_short.questions_answered(ledger) == (
        "The paper's claims raise 5 questions; these runs ask 4 and answer 3. The answers "
        f"beside the main claims follow. Reproduced: {a.ask} Yes†. Not reproduced: {c.ask} No. "
        "Not answered: 1 too short."
    )


def test_only_tests_that_hold_after_correction_are_named() -> None:
    rules = effects(HIGHER, {"method": "oja", "low": 0.5}, {"method": "hebb", "task": "cartpole"})
    assert in_short.against_neat(rules) == (
        "Of 3 tests of single rules, 1 holds after Holm's correction: final fitness on Hopper "
        f"(BCM higher). {NOT_CORRECTED}"
    )
    assert in_short.against_neat(effects({})) == (
        f"Of 1 tests of single rules, none hold after Holm's correction. {NOT_CORRECTED}"
    )
    assert in_short.against_neat(effects({"p_holm": float("nan")})) == ("No test could be made.")


def test_what_the_ablation_shares_is_no_learning() -> None:
    table = effects(
        {"method": "neat_wo", "outcome": SCORE, "low": 0.1},
        {"against": "neat_wo", "difference": -2.0, "low": -3.0, "high": -1.0},
        {"against": "neat_wo", "method": "oja", "low": 0.1, "near_control": True},
    )
    assert in_short.is_it_learning(table) == (
        "NEAT without weight mutation (NEAT (w/o)), which does not learn either, differs from NEAT "
        "too: SCORE on Hopper (higher). From NEAT (w/o) the rules differ in 1 of 1 comparisons, "
        "uncorrected: final fitness on Hopper (BCM lower). In 1 other comparisons the rule "
        "hardly moves a weight (†), so they cannot show learning."
    )
    assert in_short.is_it_learning(table[:0]) == "No run of NEAT (w/o) is there to tell."


def test_fresh_episodes_show_the_selection_bias() -> None:
    rows = [("hopper", 195.2), ("hopper", 397.9), ("cartpole", float("nan"))]
    assert in_short.in_fresh_episodes(pd.DataFrame(rows, columns=["task", "mean"])) == (
        "Final best fitness is a maximum over noisy episodes. In fresh episodes, champions return "
        "195 to 398 less on Hopper."
    )


def test_a_point_has_its_lead_in_bold() -> None:
    assert in_short.Point("Lead.", "Text.").markdown() == "**Lead.** Text."
