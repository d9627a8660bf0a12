"""The costs of what a budget's runs leave open."""

import pandas as pd
import pytest

from neol.spec.configuration import ROOT, load_configuration
from neol.study.campaign.grid import RESULTS
from neol.study.claims.ledger import WHOLE
from neol.study.claims.questions import load_questions
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.report.further_runs import costs_by_task

QUESTIONS = load_questions()
CAMPAIGN = Campaign(load_configuration("evidence"), ROOT / RESULTS)


def ledger(**verdicts: str) -> pd.DataFrame:
    """Return a ledger whose questions are decided, but those that are named by a task."""
    alone = {(task,): verdict for task, verdict in verdicts.items()}
    rows = [
        {"question": each.id, "part": WHOLE, "verdict": alone.get(each.tasks, "not reproduced")}
        for each in QUESTIONS
    ]
    return pd.DataFrame(rows)


def rows(campaign, ledger):
    head, *rows = costs_by_task(campaign, ledger)
    return {row[0]: dict(zip(head, row, strict=True)) for row in rows}


@pytest.mark.parametrize("verdict", ["too short", "not asked here", "inconclusive"])
def test_open_questions_are_counted_by_task(verdict):
    found = rows(CAMPAIGN, ledger(hopper=verdict))
    of_hopper = sum(each.tasks == ("hopper",) for each in QUESTIONS)
    alone = {task: row["open questions on it alone"] for task, row in found.items()}
    assert of_hopper > 1
    expected = {"Lunar Lander": "0", "CartPole": "0", "Bipedal Walker": "0"}
    assert alone == expected | {"Hopper": str(of_hopper)}
    assert {row["on it and others"] for row in found.values()} == {"0"}


def test_a_question_on_several_tasks_waits_for_each():
    several = [each for each in QUESTIONS if "hopper" in each.tasks and len(each.tasks) > 1]
    table = ledger()
    table.loc[table["question"] == several[0].id, "verdict"] = "too short"
    found = rows(CAMPAIGN, table)
    assert found["Hopper"]["on it and others"] == "1"
    assert found["Hopper"]["open questions on it alone"] == "0"


def test_runs_of_the_papers_budget_are_counted_and_others_are_not():
    found = rows(CAMPAIGN, ledger())
    here = {task: row["runs here, of the paper's"] for task, row in found.items()}
    assert here["CartPole"] == "1,680 of 1,680"
    assert here["Hopper"] == "0 of 1,680"
    unrun = Campaign(load_configuration("evidence"), ROOT / "nothing", partial=True)
    assert rows(unrun, ledger())["CartPole"]["runs here, of the paper's"] == "0 of 1,680"
    hours = found["Hopper"]
    assert float(hours["core-hours of all runs"]) > float(hours["of those in Tables 3 and 4"]) > 0
