"""What it would cost to answer the questions that a budget's runs leave open, task by task."""

import pandas as pd

from neol.pictures.labels import task_label, three_figures
from neol.spec.configuration import PAPER_BUDGET, Configuration, load_configuration
from neol.study.campaign.cost import core_hours
from neol.study.campaign.grid import blocks, home
from neol.study.campaign.shown import with_tasks
from neol.study.claims.ledger import WHOLE
from neol.study.claims.questions import Question, load_questions
from neol.study.claims.verdicts import UNASKED
from neol.study.outcomes.campaign_runs import Campaign

OPEN = (*UNASKED, "inconclusive")
"""Verdicts that further runs may replace."""


def costs_by_task(campaign: Campaign, ledger: pd.DataFrame) -> list[list[str]]:
    """Return a head, then a row for each task of the paper.

    A row has the open questions on this task alone and on several tasks, how many of the paper's
    runs are already here, and the measured core-hours of all and of Tables 3 and 4's cells.
    """
    whole = ledger[ledger["part"] == WHOLE].set_index("question")["verdict"]
    waiting = [each for each in load_questions() if whole[each.id] in OPEN]
    papers, named = (
        load_configuration(PAPER_BUDGET, changes, reading=campaign.configuration.reading)
        for changes in ([], ["budget.configurations=tables"])
    )
    rows = [
        [
            "task",
            "open questions on it alone",
            "on it and others",
            "runs here, of the paper's",
            "core-hours of all runs",
            "of those in Tables 3 and 4",
        ]
    ]
    for task in papers.budget.tasks:
        asked = [tasks for each in waiting if task in (tasks := _tasks(each))]
        alone = sum(tasks == {task} for tasks in asked)
        rows.append(
            [
                task_label(task),
                str(alone),
                str(len(asked) - alone),
                f"{_runs_here(campaign, papers, task):,} of {_runs(papers, task):,}",
                _hours(papers, task),
                _hours(named, task),
            ]
        )
    return rows


def _tasks(question: Question) -> set[str]:
    return {*question.tasks, *getattr(question, "than_tasks", ())}


def _runs_here(campaign: Campaign, papers: Configuration, task: str) -> int:
    """Count the campaign's runs of a task that have records and are part of the paper's budget."""
    here = blocks(campaign.configuration)
    cells = {each.cell for each in here if each.cell.task == task and each.home == home(papers)}
    return sum(len(campaign.runs(cell).cpu_seconds) for cell in cells)


def _runs(papers: Configuration, task: str) -> int:
    return sum(len(block.seeds) for block in blocks(papers) if block.cell.task == task)


def _hours(configuration: Configuration, task: str) -> str:
    """Return the measured cost of a configuration's runs of a task."""
    hours = core_hours(with_tasks(configuration, [task]))
    return "--" if hours is None else three_figures(hours)
