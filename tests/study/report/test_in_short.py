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
    "They are not corrected for earlier looks at fewer seeds. For SCORE the same seeds choose a "
    "rule's learning rate and test it, which favours the rule; the paper's questions use separate "
    "seeds."
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
        "The paper's claims raise 5 questions, those of the main claims among them; these runs "
        "ask 4 and answer 3. The answers beside the main claims follow. "
        f"Reproduced: {a.ask} Yes†. Not reproduced: {c.ask} No. Not answered: 1 too short."
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
        "Not shown. NEAT without weight mutation (NEAT (w/o)) cannot learn within an episode. Of 1 "
        "comparisons with it, uncorrected, a rule is distinguishably above in none and below in 1: "
        "final fitness (Hopper: BCM). In 1 other comparisons the rule hardly moves a weight (†), "
        "so they cannot show learning. NEAT (w/o) itself differs from NEAT: SCORE on Hopper "
        "(higher)."
    )
    above = [{"against": "neat_wo", "low": 0.1, "method": rule} for rule in ("bcm", "oja")]
    said = in_short.is_it_learning(effects(*above, above[0] | {"outcome": SCORE}))
    assert said.startswith("In part. ")
    assert "above in 3: final fitness (Hopper: BCM, Oja) and SCORE (Hopper: BCM) and below" in said
    assert in_short.is_it_learning(table[:0]) == "No run of NEAT (w/o) is there to tell."


def test_fresh_episodes_show_the_selection_bias() -> None:
    rows = [("hopper", 195.2), ("hopper", 397.9), ("cartpole", float("nan"))]
    assert in_short.in_fresh_episodes(pd.DataFrame(rows, columns=["task", "mean"])) == (
        "Final best fitness is a maximum over noisy episodes. In fresh episodes, champions return "
        "195 to 398 less on Hopper. Each range is over the methods and population sizes, with the "
        "mean over learning rates and seeds."
    )


def test_the_mark_is_explained_where_a_rule_has_it() -> None:
    assert in_short.terms(effects({})) == " ".join(in_short.TERMS)
    assert in_short.terms(effects({}, {"near_control": True})).endswith(in_short.MARK)


def test_a_point_has_its_lead_in_bold() -> None:
    assert in_short.Point("Lead.", "Text.").markdown() == "**Lead.** Text."
