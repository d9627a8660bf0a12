"""`neol status`: plain lines, and the watch."""

from pathlib import Path

import pytest

from neol.cli import status as command
from neol.cli.status_view import age
from neol.study.campaign import shown
from neol.study.workflow.status import Folder
from tests.helpers.command import neol, refused
from tests.study.workflow.conftest import CONFIGURATION, finish, job, log
from tests.study.workflow.conftest import unmeasured as unmeasured


@pytest.fixture
def smoke(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Folder:
    """Return the folder of a known budget, below the working folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shown, "select", lambda *_: CONFIGURATION)
    return Folder(Path("results/rare_mutation/smoke"), CONFIGURATION)


@pytest.mark.usefixtures("unmeasured")
def test_status_is_plain_lines(smoke: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    finish(job(smoke))
    log(job(smoke, place=1), "neol: disk full\n")
    outcome = neol("status results/rare_mutation/smoke")
    assert outcome.exit_code == 0, outcome.output
    lines = [line.rstrip() for line in outcome.stdout.splitlines()]
    assert lines[0] == (
        "results/rare_mutation/smoke: 3 of 96 runs done, 1 of 32 cells, "
        "0 of 63 of the sensitivity study, "
        "1 failed"
    )
    assert lines[1].startswith("The cost of cartpole, hopper was never measured; no run is in")
    assert lines[3].startswith("  cartpole hebb P=6 eta=0.0025 seed 2: best 7.0, held-out mean 6.0")
    failed = lines[lines.index("Failed:") + 1]
    assert failed.startswith("  cartpole hebb P=6 eta=0.25 seed 0: neol: disk full (")
    assert failed.endswith("logs/rare_mutation/smoke/cartpole/hebb/p006_lr0.25/seeds_000-002.log)")
    header, hebb, *_ = lines[lines.index("") + 1 :]
    assert header.split()[:4] == ["task", "method", "runs", "done"]
    assert hebb.split()[:4] == ["cartpole", "hebb", "12", "3"]
    assert hebb.endswith(" unknown")
    assert neol("status smoke").stdout.splitlines()[0] == lines[0]
    monkeypatch.chdir("results/rare_mutation/smoke")
    assert neol("status .").stdout.splitlines()[0].endswith(lines[0])


def test_watch_goes_on_until_the_grid_is_done(
    smoke: Folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    grid = [s.job for s in smoke.job_statuses() if s.job.part != "sensitivity"]
    finish(grid[0])

    def work(_seconds: float) -> None:
        for each in grid[1:]:
            finish(each)

    monkeypatch.setattr(command.time, "sleep", work)
    outcome = neol("status smoke --watch")
    assert outcome.stdout.startswith(
        "results/rare_mutation/smoke: 3 of 96 runs done, 1 of 32 cells"
    )
    assert "results/rare_mutation/smoke: 96 of 96 runs done, 32 of 32 cells" in outcome.stdout


def test_when_all_is_done_there_is_one_line(smoke: Folder) -> None:
    for status in smoke.job_statuses():
        finish(status.job)
    assert neol("status smoke").stdout == (
        "results/rare_mutation/smoke: 96 of 96 runs done, 32 of 32 cells, "
        "63 of 63 of the sensitivity study: all runs are done\n"
    )


def interrupt(_seconds: float) -> None:
    raise KeyboardInterrupt


def test_ctrl_c_ends_a_watch(smoke: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    smoke.path.mkdir(parents=True)
    monkeypatch.setattr(command.time, "sleep", interrupt)
    outcome = neol("status smoke --watch")
    assert outcome.exit_code == 130
    assert outcome.stderr.endswith("neol: interrupted\n")
    assert outcome.stdout.count("0 of 96 runs done") == 1


@pytest.mark.usefixtures("smoke")
def test_a_folder_that_does_not_exist_is_said() -> None:
    outcome = neol("status smoke")
    assert outcome.exit_code == 0
    assert outcome.stderr.startswith("neol: results/rare_mutation/smoke does not exist (from ")


@pytest.mark.usefixtures("smoke")
def test_a_folder_that_does_not_exist_is_not_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command.time, "sleep", interrupt)
    assert "neol: results/rare_mutation/smoke does not exist (from " in refused(
        "status smoke --watch"
    )


def test_a_folder_of_no_budget_is_refused(tmp_path: Path) -> None:
    outcome = neol("status", tmp_path / "results" / "desky")
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith("neol: ") and "desk" in outcome.stderr


def test_ages() -> None:
    ages = {-1: "0 seconds", 59.6: "59 seconds", 60: "1 minute", 7200: "2 hours", 538_000: "6 days"}
    assert [age(seconds) for seconds in ages] == list(ages.values())
