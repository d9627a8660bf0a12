"""Functions for the Snakefile: arguments, reasons, and stale locks."""

import errno
import os
import platform
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import pytest

from neol.run.record_file import write_record
from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.jobs import Job, jobs
from neol.study.campaign.shown import DEFAULT_BUDGET, select
from neol.study.workflow.snakemake import clear_stale_locks, pattern, refuse_unknown_exhibits
from tests.helpers.command import specification
from tests.helpers.made_up import run
from tests.helpers.refusal import refusal

READING = "first+plasticity.write_back=false"
JOBS = list(jobs(load_configuration("smoke", reading=READING)))


@pytest.mark.parametrize("job", JOBS[::7], ids=lambda job: str(job.record.relative_to(RESULTS)))
def test_the_arguments_of_a_job_are_its_specification(
    job: Job, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec, settings = specification(f"run {job.arguments} --output a.parquet", monkeypatch)
    assert spec == job.spec
    assert (settings["budget"], settings["reading"]) == ("smoke", READING)
    assert settings["seeds"] == list(job.seeds)


def test_every_record_is_made_by_one_job() -> None:
    assert len({job.record for job in JOBS}) == len(JOBS)


def test_the_reason_is_what_the_record_says(tmp_path: Path) -> None:
    job = replace(JOBS[0], record=tmp_path / "a.parquet", seeds=range(1))
    assert job.reason() == f"{job.record} is missing"
    write_record(job.record, run(job.spec, "smoke", 1.0))
    assert job.reason() is None
    neat = job.spec.neat.model_copy(update={"elitism": 3})
    changed = replace(job, spec=job.spec.model_copy(update={"neat": neat}))
    difference = "neat.elitism is 2 there and 3 here"
    assert changed.reason() == f"{job.record} is of another specification: {difference}"
    more = replace(job, seeds=range(5))
    assert more.reason() == f"{job.record} is of other seeds than 0 to 4"
    job.record.write_bytes(b"damaged")
    assert job.reason() is None  # whoever reads it says so


def test_a_pattern_matches_its_records_only() -> None:
    records = [RESULTS / "smoke" / "hebb" / "lr0.25" / f"seeds_{n}.parquet" for n in (1, 2)]
    assert re.fullmatch(pattern(records), "smoke/hebb/lr0.25/seeds_2")
    assert not re.fullmatch(pattern(records), "smoke/hebb/lr0925/seeds_2")
    assert not re.fullmatch(pattern([]), "")


HOLD = """
from neol.study.campaign.shown import DEFAULT_BUDGET, select
from neol.study.workflow.snakemake import clear_stale_locks
alive = clear_stale_locks()
print(flush=True)
input()
"""


@pytest.mark.slow
def test_locks_are_cleared_once_nobody_lives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    locks = tmp_path / ".snakemake" / "locks"
    locks.mkdir(parents=True)
    (locks / "0.input.lock").touch()
    with subprocess.Popen(
        [sys.executable, "-c", HOLD], cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as other:
        assert other.stdout is not None
        other.stdout.readline()
        assert not any(locks.iterdir())  # it was the first
        (locks / "0.output.lock").touch()  # its own
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(tmp_path)
            alive = clear_stale_locks()
        assert any(locks.iterdir())
        other.kill()
    monkeypatch.chdir(tmp_path)
    assert alive is not None
    alive.close()
    with clear_stale_locks() or pytest.fail("cannot be held"):
        assert not any(locks.iterdir())


def test_the_machine_is_on_the_disk_while_its_workflow_lives(tmp_path: Path) -> None:
    with clear_stale_locks(tmp_path) or pytest.fail("cannot be held"):
        assert (tmp_path / "alive").read_text() == platform.node()


def test_locks_of_another_machine_are_left(tmp_path: Path) -> None:
    (tmp_path / "alive").write_text("elsewhere")
    (tmp_path / "locks").mkdir()
    (tmp_path / "locks" / "0.input.lock").touch()
    assert clear_stale_locks(tmp_path) is None
    assert any((tmp_path / "locks").iterdir())


@pytest.mark.parametrize(
    ("argument", "said"),
    [
        ("figures/table9.tex", "makes no such file (in figures/: table1, table2, "),
        ("table1.pdf", "makes no such file, did you mean figures/table1.tex? (in "),
        ("figure2", "makes no such file, did you mean figures/figure2.pdf? (in "),
        ("figures/demo/table1.tex", "did you mean figures/table1.tex?"),
        ("figures/figure6.pdf", "file: figure6 needs the whole grid, as budget paper has it (in "),
    ],
)
def test_what_no_rule_makes_is_said_with_what_there_is(argument: str, said: str) -> None:
    line = refusal(refuse_unknown_exhibits, ["--dry-run", argument], select())
    assert line.startswith(f"{argument}: budget {DEFAULT_BUDGET} makes no such file")
    assert said in line


def test_what_is_made_is_not_refused() -> None:
    targets = ["tables", "figures/table1.tex", "figures/figure2.png", "figures/report.html", "all"]
    refuse_unknown_exhibits([*targets, "--config", f"budget={DEFAULT_BUDGET}"], select())


def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    said = refusal(clear_stale_locks, tmp_path / "file" / ".snakemake")
    assert "file/.snakemake: cannot be written (Not a directory); Snakemake needs it, even" in said


def test_a_full_disk_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_file: int) -> NoReturn:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    said = refusal(clear_stale_locks, tmp_path)
    assert said.startswith(f"{tmp_path}: cannot be written (No space left on device); Snakemake")
