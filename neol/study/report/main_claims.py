"""Whether the paper's main claims hold: one sentence, and a table of those that are asked.

By these claims the rules end higher than NEAT and than NEAT (w/o), with a higher SCORE and less
variation over seeds: the questions of three families in paper/questions.yaml.
"""

from collections.abc import Hashable, Mapping
from typing import Any

import pandas as pd

from neol.pictures.labels import listed, method_label, task_label, three_figures
from neol.study.claims.ledger import WHOLE
from neol.study.claims.questions import RULES, Difference, main_questions
from neol.study.claims.units import in_print, interval_in_print
from neol.study.claims.verdicts import AGAINST, FOR, OPPOSITE
from neol.study.report.in_short import ANSWERS, Point

CLAIMED = {
    "fitness": "end higher than",
    "SCORE": "have a higher SCORE than",
    "spread": "vary less over seeds than",
}
"""What the main claims of each family say of the rules."""
HEAD = (
    "do the rules ...",
    "answer",
    "effect [interval]",
    *map(method_label, RULES),
    "the paper's effect",
)
EFFECTS = (
    "An effect is the mean of the three rules minus the baseline's, for variation over seeds the "
    "ratio of standard deviations, with its interval. That of each rule alone and the one that the "
    "paper prints follow."
)
"""What the table's numbers are."""
NOT_ASKED = "not asked here"
UNDECIDED = {"inconclusive": "Open", "too short": "Too short"}
TOO_LITTLE = "Not as much"
"""Answer where a claim is not reproduced, but the other direction is not shown either."""


def do_they_hold(ledger: pd.DataFrame) -> Point:
    """Say in a few sentences what the verdicts on the main claims are."""
    questions = main_questions()
    rows = ledger[ledger["part"] == WHOLE].set_index("question").loc[[q.id for q in questions]]
    there = rows[rows["verdict"] != NOT_ASKED]
    asked = list(there["verdict"])
    sides = {
        "for the paper": sum(verdict in FOR for verdict in asked),
        "in part": sum(verdict == "mixed" for verdict in asked),
        "against it": sum(verdict in AGAINST for verdict in asked),
    }
    decided = sum(sides.values())
    counts = listed(
        f"{count or 'none'} {side}" for side, count in sides.items() if count or side != "in part"
    )
    opposite = sum(there["reason"] == OPPOSITE)
    where = f", all on {_tasks_of(there)}," if len(set(there["tasks"])) == 1 else ""
    return Point(
        _lead(sides, decided),
        "The paper's main claims are that its rules end higher than NEAT, and than NEAT without "
        "weight mutation, with better sample efficiency and less variation over seeds: "
        f"{len(questions)} questions on {_tasks_of(rows)}. These runs ask {len(asked) or 'none'} "
        f"of them{where} and decide {f'{decided}: {counts}' if decided else 'none'}"
        f"{f', {opposite} of these in the other direction' if opposite else ''}.",
    )


def _tasks_of(rows: pd.DataFrame) -> str:
    return listed(map(task_label, dict.fromkeys(rows["tasks"])))


def answers_table(ledger: pd.DataFrame) -> list[list[str]]:
    """Return a head, and a row for each main claim, baseline and task that is asked.

    A row has the answer; the effect of all rules together, with the interval of its look; that of
    each rule; and the one that the paper prints. The table is empty where nothing is asked.
    """
    rows = ledger[ledger["part"] == WHOLE].set_index("question").to_dict("index")
    parts = ledger[ledger["part"] != WHOLE].groupby("question")
    asked = [
        _row(question, rows[question.id], parts.get_group(question.id))
        for question in main_questions()
        if rows[question.id]["verdict"] != NOT_ASKED
    ]
    return [list(HEAD), *asked] if asked else []


def about_the_table(ledger: pd.DataFrame) -> str:
    """Explain the table's numbers, and say how many of the main claims are not asked, and why."""
    rows = ledger[ledger["part"] == WHOLE].set_index("question")["verdict"]
    unasked: dict[str, list[bool]] = {}
    for question in main_questions():
        (task,) = question.tasks
        unasked.setdefault(task, []).append(rows[question.id] == NOT_ASKED)
    missing = listed(
        f"{'all' if all(each) else f'{sum(each)} of'} {len(each)} on {task_label(task)}"
        for task, each in unasked.items()
        if any(each)
    )
    if not missing:
        return EFFECTS
    return (
        f"{EFFECTS} Not asked: {missing}, because the paper's settings were not run (generations, "
        "populations, learning rates), or with too few seeds."
    )


def _lead(sides: Mapping[str, int], decided: int) -> str:
    if not decided:
        return "Not decided by these runs."
    if decided == sides["against it"]:
        return "No, where these runs decide."
    return "Yes, where these runs decide." if decided == sides["for the paper"] else "In part."


def _row(question: Difference, row: Mapping[Hashable, Any], parts: pd.DataFrame) -> list[str]:
    """Return what is asked, the answer and the effects."""
    (task,), baseline = question.tasks, method_label(str(question.against.method))
    of_rule = dict(zip(parts["part"], parts["effect"], strict=True))
    effects = [*(of_rule[f"{task}: {rule}"] for rule in RULES), row["paper_effect"]]
    return [
        f"{CLAIMED[str(question.family)]} {baseline} on {task_label(task)}?",
        _answer(row),
        interval_in_print(question, row["effect"], row["low"], row["high"]),
        *(three_figures(*in_print(question, effect)) for effect in effects),
    ]


def _answer(row: Mapping[Hashable, Any]) -> str:
    """Return an answer with its reason, for example: No (the other direction)."""
    verdict, reason = row["verdict"], row["reason"]
    answer = (ANSWERS | UNDECIDED)[verdict]
    if verdict == "not reproduced" and reason != OPPOSITE:
        answer = TOO_LITTLE
    return f"{answer} ({reason})" if isinstance(reason, str) and reason else answer
