"""Whether the paper's main claims hold: the sentence and the table."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

from neol.study.claims.questions import main_questions
from neol.study.claims.verdicts import OPPOSITE
from neol.study.report.main_claims import (
    EFFECTS,
    about_the_table,
    answers_table,
    do_they_hold,
)


def ledger(reason: str = "why", **verdicts: str) -> pd.DataFrame:
    """Verdicts on the main claims' questions by id (with _ for -); others are not asked."""
    rows: list[dict[str, Any]] = []
    for question in main_questions():
        verdict = verdicts.get(question.id.replace("-", "_"), "not asked here")
        numbers = {"effect": 1.0, "low": 0.5, "high": 1.5, "paper_effect": 12.0}
        if verdict == "not asked here":
            numbers = dict.fromkeys(numbers, np.nan)
        rows += [
            {
                "question": question.id,
                "part": "all",
                "tasks": question.tasks[0],
                "verdict": verdict,
                **numbers,
                "reason": reason,
            },
            *(
                {
                    "question": question.id,
                    "part": f"{question.tasks[0]}: {rule}",
                    "tasks": question.tasks[0],
                    "verdict": verdict,
                    **numbers,
                    "effect": numbers["effect"] * place,
                    "reason": "",
                }
                for place, rule in enumerate(question.rules, start=1)
            ),
        ]
    return pd.DataFrame(rows)


@pytest.mark.parametrize(
    ("verdicts", "lead", "counts"),
    [
        ([], "Not decided by these runs.", "These runs ask none of them and decide none."),
        (["inconclusive"], "Not decided by these runs.",
         "These runs ask 1 of them, all on Lunar Lander, and decide none."),
        (["too short", "not reproduced", "equivalent to zero"], "No, where these runs decide.",
         "These runs ask 3 of them and decide 2: none for the paper and 2 against it."),
        (["reproduced", "same direction"], "Yes, where these runs decide.",
         "These runs ask 2 of them and decide 2: 2 for the paper and none against it."),
        (["reproduced", "mixed", "not reproduced"], "In part.",
         "decide 3: 1 for the paper, 1 in part and 1 against it."),
    ],
)  # fmt: skip
def test_the_answer_says_no_more_than_the_verdicts(
    verdicts: list[str], lead: str, counts: str
) -> None:
    names = [question.id.replace("-", "_") for question in main_questions()]
    point = do_they_hold(ledger(**dict(zip(names, verdicts, strict=False))))
    assert point.lead == lead
    assert "18 questions on Lunar Lander, Hopper and Bipedal Walker." in point.text
    assert point.text.endswith(counts)


def test_the_table_has_a_row_for_each_claim_that_is_asked() -> None:
    made_up = ledger(final_neat_hopper="not reproduced", spread_neat_wo_lunar_lander="inconclusive")
    head, higher, spread = answers_table(made_up)
    assert head[3:6] == ["BCM", "Hebb", "Oja"]
    assert higher == [
        "end higher than NEAT on Hopper?",
        "Not as much (why)",
        "1.00 [0.500, 1.50]",
        "1.00",
        "2.00",
        "3.00",
        "12.0",
    ]
    assert spread[:3] == [
        "vary less over seeds than NEAT (w/o) on Lunar Lander?",
        "Open (why)",
        "2.72 [1.65, 4.48]",
    ]
    assert about_the_table(made_up).endswith(
        "Not asked: 5 of 6 on Lunar Lander, 5 of 6 on Hopper and all 6 on Bipedal Walker, because "
        "the paper's settings were not run (generations, populations, learning rates), or with too "
        "few seeds."
    )


def test_nothing_asked_makes_no_table() -> None:
    assert answers_table(ledger()) == []


def test_nothing_is_missing_where_all_is_asked() -> None:
    asked = {question.id.replace("-", "_"): "reproduced" for question in main_questions()}
    assert len(answers_table(ledger(**asked))) == 1 + len(asked)
    assert about_the_table(ledger(**asked)) == EFFECTS


def test_the_other_direction_is_told_from_too_little() -> None:
    made_up = ledger(OPPOSITE, final_neat_hopper="not reproduced")
    point = do_they_hold(made_up)
    assert "ask 1 of them, all on Hopper, and decide 1: none for the paper and 1 " in point.text
    assert point.text.endswith("against it, 1 of these in the other direction.")
    _, row = answers_table(made_up)
    assert row[1] == "No (the other direction)"
