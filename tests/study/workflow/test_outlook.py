"""Estimated cost of the rest of a campaign."""

import pytest

from neol.run.workspace import partial_folder
from neol.study.campaign.cost import run_seconds
from neol.study.workflow import status as states
from neol.study.workflow.outlook import Row, Status
from neol.study.workflow.status import Folder
from tests.study.workflow.conftest import finish, job


def row(folder: Folder, task: str, part: str) -> Row:
    return next(r for r in Status(folder.job_statuses()).rows if (r.task, r.part) == (task, part))


@pytest.mark.usefixtures("unmeasured")
def test_of_an_empty_folder_all_is_missing_and_no_cost_known(folder: Folder) -> None:
    status = Status(folder.job_statuses())
    assert status.states() == {"missing": 96}
    assert status.cells == (0, 32)
    assert [(r.task, r.part) for r in status.rows][-2:] == [
        ("hopper", "neat_wo"),
        ("cartpole", "sensitivity"),
    ]
    assert {r.core_hours for r in status.rows} == {None}
    assert status.seconds_left is None
    assert not status.over


def test_a_run_costs_what_was_measured(folder: Folder) -> None:
    hebb = [
        s.job
        for s in folder.job_statuses()
        if (s.job.spec.task.name, s.job.part) == ("hopper", "hebb")
    ]
    seconds = sum(3 * (run_seconds(each.spec) or 0.0) for each in hebb)
    assert row(folder, "hopper", "hebb").core_hours == pytest.approx(seconds / 3600.0)


def test_the_rest_of_a_task_costs_what_its_finished_runs_did(folder: Folder) -> None:
    before = {task: row(folder, task, "hebb").core_hours for task in ("cartpole", "hopper")}
    done = job(folder)
    finish(done)
    predicted = 3 * (run_seconds(done.spec) or 0.0)
    spent = sum(run.cpu_seconds for run in Status(folder.job_statuses()).finished)
    assert spent != pytest.approx(predicted)
    rest = row(folder, "cartpole", "hebb").core_hours
    assert before["cartpole"] is not None
    expected = (before["cartpole"] - predicted / 3600.0) * spent / predicted
    assert rest == pytest.approx(expected)
    assert row(folder, "hopper", "hebb").core_hours == before["hopper"]


def test_the_time_left_is_that_of_the_jobs_that_run(
    folder: Folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert Status(folder.job_statuses()).seconds_left is None
    for place in (1, 2):
        partial_folder(job(folder, place=place).record).mkdir(parents=True)
    monkeypatch.setattr(states, "is_running", lambda _: True)
    status = Status(folder.job_statuses())
    hours = sum(r.core_hours or 0.0 for r in status.rows)
    assert status.seconds_left == pytest.approx(3600 * hours / 2)
