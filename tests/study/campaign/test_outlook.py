"""What the rest of a campaign costs."""

import pytest

from neol.run.workspace import partial_folder
from neol.study.campaign import status as states
from neol.study.campaign.cost import run_seconds
from neol.study.campaign.outlook import BASES, Row, Status
from neol.study.campaign.status import Folder
from tests.study.campaign.conftest import finish, job


def row(folder: Folder, task: str, part: str) -> Row:
    return next(r for r in Status(folder.look()).rows if (r.task, r.part) == (task, part))


@pytest.mark.usefixtures("unmeasured")
def test_of_an_empty_folder_all_is_missing_and_no_cost_known(folder: Folder) -> None:
    status = Status(folder.look())
    assert status.states() == {"missing": 96}
    assert status.cells == (0, 32)
    assert [(r.task, r.part) for r in status.rows][-3:] == [
        ("hopper", "neat_wo"),
        ("cartpole", "sensitivity"),
        ("hopper", "sensitivity"),
    ]
    assert {(r.core_hours, r.basis) for r in status.rows} == {(None, "")}
    assert status.seconds_left is None
    assert not status.over


def test_where_nothing_is_done_a_run_costs_what_was_measured(folder: Folder) -> None:
    hebb = [
        s.job for s in folder.look() if (s.job.spec.task.name, s.job.part) == ("hopper", "hebb")
    ]
    seconds = sum(3 * (run_seconds(each.spec) or 0.0) for each in hebb)
    assert row(folder, "hopper", "hebb").core_hours == pytest.approx(seconds / 3600.0)
    assert row(folder, "hopper", "hebb").basis == "the shipped measurements"


@pytest.mark.usefixtures("unmeasured")
def test_the_rest_costs_what_the_nearest_finished_runs_did(folder: Folder) -> None:
    finish(job(folder), cpu_seconds=3600.0)  # Hebb's first of two rates at P = 6
    hebb = row(folder, "cartpole", "hebb")
    assert hebb.core_hours == pytest.approx(3 * 1 + 6 * 2)  # P = 12 costs twice as much
    assert hebb.basis == BASES[1]
    oja = row(folder, "cartpole", "oja")
    assert oja.core_hours == pytest.approx(6 * 1 + 6 * 2)
    assert oja.basis == BASES[2]
    assert row(folder, "hopper", "hebb").core_hours is None
    finish(job(folder, place=2), cpu_seconds=36.0)  # the same at P = 12
    assert row(folder, "cartpole", "hebb").core_hours == pytest.approx(3 * 1 + 3 * 0.01)
    assert row(folder, "cartpole", "hebb").basis == BASES[0]


def test_the_time_left_is_that_of_the_jobs_that_run(
    folder: Folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    for task in ("cartpole", "hopper"):
        finish(job(folder, task), cpu_seconds=10.0)
    assert Status(folder.look()).seconds_left is None
    for place in (1, 2):
        partial_folder(job(folder, place=place).record).mkdir(parents=True)
    monkeypatch.setattr(states, "is_running", lambda _: True)
    status = Status(folder.look())
    hours = sum(r.core_hours or 0.0 for r in status.rows)
    # Two jobs run, each at half a core: that is what the finished runs got.
    assert status.seconds_left == pytest.approx(3600 * hours / (2 * 0.5))
