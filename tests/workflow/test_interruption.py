"""Killed workflows: finished seeds are kept, and the same command continues."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from neol.run import checkpoint
from neol.run.record import SeedInfo
from neol.run.record_file import read_record
from neol.run.runner import run_block
from neol.run.workspace import checkpoint_path, finished_path, partial_folder
from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec
from neol.study.campaign.grid import blocks, run_specs
from tests.helpers.runs import result
from tests.workflow.clone import fresh_clone, snakemake

pytestmark = pytest.mark.slow

BUDGET = {
    "generations": "150",
    "seeds": "3",
    "populations": "[20]",
    "learning_rates": "[0.25]",
    "tasks": "[cartpole]",
    "methods": "[oja]",
    "seeds_per_job": "3",
}
COMMAND = ("records", "--config", "budget=mini", "--cores", "1")
RECORD = Path("results/rare_mutation/mini/cartpole/oja/p020_lr0.25/seeds_000-002.parquet")


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A clone with a budget of one block, which takes some seconds."""
    clone = fresh_clone(tmp_path_factory.mktemp("interruption") / "neol")
    lines = [f"  {key}: {value}\n" for key, value in BUDGET.items()]
    (clone / "config" / "mini.yaml").write_text("budget:\n" + "".join(lines))
    return clone


@pytest.fixture(scope="module")
def spec() -> RunSpec:
    overrides = [f"budget.{key}={value}" for key, value in BUDGET.items()]
    configuration = load_configuration("paper", overrides)
    (block,) = blocks(configuration)
    return run_specs(configuration, block)[0]


@pytest.fixture(scope="module")
def undisturbed(spec: RunSpec, tmp_path_factory: pytest.TempPathFactory) -> object:
    output = tmp_path_factory.mktemp("undisturbed") / "run.parquet"
    return result(run_block(spec, range(3), output))


def start(clone: Path) -> psutil.Process:
    """Start the workflow in its own process group; return when its job has finished one seed."""
    workflow = psutil.Popen(
        [sys.executable, "-m", "snakemake", *COMMAND],
        cwd=clone,
        env=os.environ | {"PYTHONPATH": str(clone)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    partial = partial_folder(clone / RECORD)
    while not (finished_path(partial, 0).exists() and checkpoint_path(partial, 1).exists()):
        assert workflow.poll() is None
        time.sleep(0.01)
    return workflow


def kept(clone: Path, spec: RunSpec) -> SeedInfo:
    """Return the first seed's results; the second's checkpoint is marked by its cost."""
    partial = partial_folder(clone / RECORD)
    path = checkpoint_path(partial, 1)
    evolution, past = checkpoint.read_checkpoint(path, spec.model_copy(update={"seed": 1}))
    assert evolution.generation >= 10
    checkpoint.write_checkpoint(
        path, evolution, replace(past, wall_seconds=past.wall_seconds + 1e6)
    )
    return read_record(finished_path(partial, 0)).seeds[0]


def assert_finishes(clone: Path, first: SeedInfo, undisturbed: object) -> None:
    """Check that the same command continues and repeats no finished seed or checkpoint."""
    done = snakemake(clone, *COMMAND)
    assert done.returncode == 0, done.stderr
    record = read_record(clone / RECORD)
    assert result(record) == undisturbed
    assert record.seeds[0] == first  # time of day and cost included
    assert record.seeds[1].wall_seconds > 1e6
    assert [path.name for path in (clone / RECORD).parent.iterdir()] == [RECORD.name]
    assert not any((clone / ".snakemake").glob("locks/*"))
    (clone / RECORD).unlink()


def test_all_killed_while_a_second_workflow_wants_in(
    clone: Path, spec: RunSpec, undisturbed: object
) -> None:
    workflow = start(clone)
    os.killpg(workflow.pid, signal.SIGSTOP)
    second = snakemake(clone, *COMMAND)
    assert second.returncode == 1
    assert "LockException" in second.stderr
    os.killpg(workflow.pid, signal.SIGKILL)
    workflow.wait()
    assert_finishes(clone, kept(clone, spec), undisturbed)


def test_the_job_killed(clone: Path, spec: RunSpec, undisturbed: object) -> None:
    workflow = start(clone)
    (job,) = (each for each in workflow.children(recursive=True) if "-m neol run" in said(each))
    job.kill()
    assert workflow.wait() == 1
    assert_finishes(clone, kept(clone, spec), undisturbed)


LINGERS = """
import atexit, sys, time
from pathlib import Path
if "run" in sys.argv:
    atexit.register(lambda: time.sleep(60 * Path("linger").exists()))
"""


def test_the_job_killed_after_its_last_write(clone: Path, undisturbed: object) -> None:
    """Snakemake removes its record, which is made again from those of its seeds."""
    (clone / "sitecustomize.py").write_text(LINGERS)
    (clone / "linger").touch()
    workflow = start(clone)
    while not (clone / RECORD).exists():
        time.sleep(0.01)
    made = read_record(clone / RECORD)
    (job,) = (each for each in workflow.children(recursive=True) if "-m neol run" in said(each))
    job.kill()
    assert workflow.wait() == 1
    assert not (clone / RECORD).exists()
    (clone / "linger").unlink()
    done = snakemake(clone, *COMMAND)
    assert done.returncode == 0, done.stderr
    assert read_record(clone / RECORD).seeds == made.seeds  # time of day and cost included
    assert result(made) == undisturbed
    assert [path.name for path in (clone / RECORD).parent.iterdir()] == [RECORD.name]
    (clone / RECORD).unlink()


def test_only_the_workflow_killed(clone: Path, undisturbed: object) -> None:
    """Its job continues, and the job of the next workflow waits for it."""
    workflow = start(clone)
    (job,) = (each for each in workflow.children(recursive=True) if "-m neol run" in said(each))
    job.suspend()
    workflow.kill()
    workflow.wait()
    next_ = psutil.Popen(
        [sys.executable, "-m", "snakemake", *COMMAND],
        cwd=clone,
        env=os.environ | {"PYTHONPATH": str(clone)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    log = clone / "logs" / RECORD.relative_to("results").with_suffix(".log")
    while "waiting for it" not in text(log):
        assert next_.poll() is None
        time.sleep(0.05)
    job.resume()
    assert next_.wait() == 0
    assert result(read_record(clone / RECORD)) == undisturbed
    (clone / RECORD).unlink()


def test_killed_before_a_constant_changed(clone: Path, spec: RunSpec, undisturbed: object) -> None:
    """The seeds that it kept are of the old constant, and do not stop the job of the new one."""
    old = spec.model_copy(update={"generations": 2})
    run_block(old, range(3), clone / RECORD, budget="mini", keep_partial=True)
    done = snakemake(clone, *COMMAND)
    assert done.returncode == 0, done.stdout
    assert result(read_record(clone / RECORD)) == undisturbed
    assert [path.name for path in (clone / RECORD).parent.iterdir()] == [RECORD.name]
    (clone / RECORD).unlink()


def text(log: Path) -> str:
    """Return a log's content; Snakemake removes the log before its job starts again."""
    try:
        return log.read_text()
    except FileNotFoundError:
        return ""


def said(process: psutil.Process) -> str:
    """Return a process's command; that of bash is not a job."""
    command = process.cmdline()
    return "" if command[0].endswith("bash") else " ".join(command)
