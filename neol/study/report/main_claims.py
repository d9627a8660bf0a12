"""Whether the paper's main claims hold: one sentence, and a table of them on each task.

By these claims the rules end higher than NEAT and than NEAT (w/o), with a higher SCORE and less
variation over seeds: the questions of three families in paper/questions.yaml.
"""

from collections.abc import Hashable, Mapping
from typing import Any

import pandas as pd

from neol.pictures.labels import listed, method_label, task_label, three_figures
from neol.study.claims.ledger import WHOLE
from neol.study.claims.questions import Difference, main_questions
from neol.study.claims.units import in_print, interval_in_print
from neol.study.claims.verdicts import AGAINST, FOR, OPPOSITE
from neol.study.report.in_short import ANSWERS, Point

CLAIMED = {
    "fitness": "end higher",
    "SCORE": "have a higher SCORE",
    "spread": "vary less over seeds (ratio of SDs)",
}
"""What the main claims of each family say of the rules."""
ABOUT = (
    "Each answer has the mean of the three rules minus the baseline's, for variation the ratio, "
    "with its interval; then that of each rule; then the effect that the paper prints. A dash: the "
    "paper's settings were not run (generations, populations, learning rates), or with too few "
    "seeds."
)
"""What the table's entries are."""
NOT_RUN = "--"
UNDECIDED = {"inconclusive": "Open", "too short": "Too short"}
TOO_LITTLE = "Not as much"
"""Answer where a claim is not reproduced, but the other direction is not shown either."""


def do_they_hold(ledger: pd.DataFrame) -> Point:
    """Say in a few sentences what the verdicts on the main claims are."""
    questions = main_questions()
    rows = ledger[ledger["part"] == WHOLE].set_index("question").loc[[q.id for q in questions]]
    there = rows[rows["verdict"] != "not asked here"]
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


def by_task(ledger: pd.DataFrame) -> list[list[str]]:
    """Return a head, then a row for each claim and baseline, with the answer on each task.

    An answer has the effect of all rules together, with the interval of its look, that of each
    rule, and the effect that the paper prints. Those on variation are ratios of standard
    deviations. The table is empty where none of the questions is asked.
    """
    rows = ledger[ledger["part"] == WHOLE].set_index("question").to_dict("index")
    parts = ledger[ledger["part"] != WHOLE].groupby("question")
    grid: dict[tuple[str, str], dict[str, str]] = {}
    for question in main_questions():
        claim = (CLAIMED[str(question.family)], method_label(str(question.against.method)))
        grid.setdefault(claim, {})[question.tasks[0]] = _answer(
            question, rows[question.id], parts.get_group(question.id)
        )
    if {NOT_RUN} == {each for answers in grid.values() for each in answers.values()}:
        return []
    tasks = list(next(iter(grid.values())))
    return [
        ["do the rules ...", "compared with", *map(task_label, tasks)],
        *([*claim, *(answers[task] for task in tasks)] for claim, answers in grid.items()),
    ]


def _lead(sides: Mapping[str, int], decided: int) -> str:
    if not decided:
        return "Not decided by these runs."
    if decided == sides["against it"]:
        return "No, where these runs decide."
    return "Yes, where these runs decide." if decided == sides["for the paper"] else "In part."


def _answer(question: Difference, row: Mapping[Hashable, Any], parts: pd.DataFrame) -> str:
    """Return an answer with its effects.

    For example: No (the other direction): -83 [-132, -34] (BCM -240, Hebb -5, Oja -4); paper's 12.
    """
    verdict = row["verdict"]
    if verdict == "not asked here":
        return NOT_RUN
    answer = (ANSWERS | UNDECIDED)[verdict]
    if verdict == "not reproduced" and row["reason"] != OPPOSITE:
        answer = TOO_LITTLE
    reason = f" ({row['reason']})" if isinstance(row["reason"], str) and row["reason"] else ""
    ours = interval_in_print(question, row["effect"], row["low"], row["high"])
    each = ", ".join(
        f"{method_label(label.split(': ')[-1])} {three_figures(*in_print(question, effect))}"
        for label, effect in zip(parts["part"], parts["effect"], strict=True)
    )
    papers = three_figures(*in_print(question, row["paper_effect"]))
    return f"{answer}{reason}: {ours} ({each}); the paper's {papers}"
