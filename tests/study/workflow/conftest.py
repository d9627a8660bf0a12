"""A results folder of a small budget, and changes of it."""

from pathlib import Path

import pytest

from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.jobs import Job
from neol.study.workflow import outlook
from neol.study.workflow.status import Folder
from tests.helpers import made_up

CONFIGURATION = made_up.configuration(tasks=("cartpole", "hopper"))
"""Three seeds a job; two generations; P = 6 and 12; Hebb, Oja and BCM with two rates each."""


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path / "results" / DEFAULT_READING / "smoke", CONFIGURATION)


def job(folder: Folder, task: str = "cartpole", part: str = "hebb", place: int = 0) -> Job:
    """Return one of a row's jobs; the first has P = 6 and the lower rate."""
    return [
        s.job for s in folder.job_statuses() if (s.job.spec.task.name, s.job.part) == (task, part)
    ][place]


def finish(of: Job, seeds: int = 3, output: Path | None = None) -> None:
    """Write a record of a number of a job's seeds."""
    made = [
        made_up.run(of.spec.model_copy(update={"seed": seed}), "smoke", 7.0, of.reading)
        for seed in list(of.seeds)[:seeds]
    ]
    made_up.write_runs(output or of.record, made)


def log(of: Job, text: str) -> None:
    of.log.parent.mkdir(parents=True, exist_ok=True)
    of.log.write_text(text)


@pytest.fixture
def unmeasured(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pretend that no task was ever measured."""
    monkeypatch.setattr(outlook, "run_seconds", lambda _spec: None)
