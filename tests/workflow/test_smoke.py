"""The smallest budget in a fresh clone: Table 1, the plan after it, then everything.

Everything has its page, and its paper where there is LaTeX.
"""

import copy
import csv
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from neol.run.record_file import read_record, write_record
from neol.spec.configuration import ROOT
from neol.spec.plain_yaml import parse_yaml
from neol.study.campaign.grid import RESULTS, blocks
from neol.study.campaign.shown import select
from neol.study.outcomes.chosen_cells import candidates
from neol.study.output.sidecar import trace
from neol.study.workflow.exhibits import EXHIBITS
from tests.study.report.test_page import Outline
from tests.workflow.clone import FIGURES, SMOKE, fresh_clone, make_records, planned, snakemake

pytestmark = pytest.mark.slow

TARGET = str(FIGURES / "table1.tex")
CONFIGURATION = select("smoke")
SHOWN = {cell for cells in candidates(CONFIGURATION).values() for cell in cells}
RECORDS = {
    RESULTS / block.record: block.cell for block in blocks(CONFIGURATION) if block.cell in SHOWN
}


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a fresh clone after `snakemake figures/smoke/table1.tex --config budget=smoke`.

    The runs of two tasks are the workflow's.
    """
    clone = fresh_clone(tmp_path_factory.mktemp("smoke") / "neol")
    made_here = ("lunar_lander", "bipedal_walker")
    make_records(clone, lambda job: job.part != "sensitivity" and job.spec.task.name in made_here)
    result = snakemake(clone, TARGET, *SMOKE)
    assert result.returncode == 0, result.stdout + result.stderr
    return clone


@contextmanager
def aside(path: Path) -> Iterator[None]:
    """Move a file or folder away for a while."""
    kept = path.with_name(f"{path.name}.aside")
    shutil.move(path, kept)
    try:
        yield
    finally:
        if path.is_dir():
            shutil.rmtree(path)
        shutil.move(kept, path)


def test_table_1_has_a_value_for_every_task_and_method(clone: Path) -> None:
    assert r"\begin{table}" in (clone / TARGET).read_text()
    with (clone / FIGURES / "table1.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 16
    assert not any(row["incomplete"] for row in rows)
    assert {row["seeds"] for row in rows} == {str(CONFIGURATION.budget.seeds)}


def test_table_1_is_traced_to_its_records(clone: Path) -> None:
    sidecar = json.loads((clone / FIGURES / "table1.json").read_text())
    assert {record["path"] for record in sidecar["records"]} == {str(path) for path in RECORDS}
    head = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=clone, check=True, capture_output=True, text=True
    )
    assert sidecar["commit"] == head.stdout.strip()


def test_the_executed_notebook_is_kept_and_its_source_untouched(clone: Path) -> None:
    executed = json.loads((clone / "build/rare_mutation/smoke/tables.ipynb").read_text())
    assert any(cell.get("outputs") for cell in executed["cells"])
    source = json.loads((clone / "notebooks/tables.ipynb").read_text())
    assert not any(cell.get("outputs") for cell in source["cells"])


def test_a_second_call_has_nothing_to_do(clone: Path) -> None:
    assert planned(clone, TARGET, *SMOKE) == {}
    assert planned(clone, str(FIGURES / "table5.tex"), *SMOKE) == {}


def test_records_of_any_age_are_used_as_they_are(clone: Path) -> None:
    """Records as after `git clone`: other times, no metadata, no figures."""
    chance = random.Random(0)
    for path in RECORDS:
        age = chance.uniform(0, 1e8)
        os.utime(clone / path, (age, age))
    with aside(clone / ".snakemake"), aside(clone / FIGURES):
        assert planned(clone, TARGET, *SMOKE) == {"tables_notebook": 1}


def test_a_deleted_record_is_the_only_run_planned(clone: Path) -> None:
    record = random.Random(1).choice(sorted(RECORDS))
    others = planned(clone, "records", *SMOKE)["run"]  # cells that Table 1 does not show
    with aside(clone / record):
        assert planned(clone, "records", *SMOKE) == {"run": others + 1}
        assert planned(clone, TARGET, *SMOKE) == {
            "run": 1,
            "tables_notebook": 1,
        }  # though it is up to date


def test_a_record_that_lacks_a_seed_is_made_again(clone: Path) -> None:
    path = next(iter(RECORDS))
    with aside(clone / path):
        record = read_record((clone / path).with_name(f"{path.name}.aside"))
        last = record.seeds[-1].seed
        kept = record.table.filter(record.table["seed"].to_numpy() < last)
        write_record(clone / path, replace(record, table=kept, seeds=record.seeds[:-1]))
        assert planned(clone, TARGET, *SMOKE) == {"run": 1, "tables_notebook": 1}


def test_a_changed_constant_plans_the_runs_that_it_affects(clone: Path) -> None:
    smoke = clone / "config" / "smoke.yaml"
    before = smoke.read_text()
    constants = copy.deepcopy(parse_yaml(before, "smoke"))
    constants.setdefault("tasks", {})["hopper"] = {"max_steps": 77}
    smoke.write_text(json.dumps(constants))
    try:
        affected = sum(cell.task == "hopper" for cell in RECORDS.values())
        assert planned(clone, TARGET, *SMOKE) == {"run": affected, "tables_notebook": 1}
    finally:
        smoke.write_text(before)


# --- Everything ---------------------------------------------------------------------------------

PAPER = ("paper" if FIGURES.name == "figures" else FIGURES) / Path("reproduction.pdf")
HAS_LATEX = shutil.which("latexmk") is not None
NEEDS_LATEX = pytest.mark.skipif(not HAS_LATEX, reason="no LaTeX on this machine")
TABLES = [each.name for each in EXHIBITS if "tex" in each.group.suffixes]
PICTURES = [each.name for each in EXHIBITS if "png" in each.group.suffixes]


@pytest.fixture(scope="module")
def whole(clone: Path) -> Path:
    """Return the clone after `snakemake all` and the paper.

    Of the sensitivity study, BCM's trials on one task are the workflow's.
    """
    left = ("cartpole", "bcm")
    make_records(
        clone,
        lambda job: job.part == "sensitivity" and (job.spec.task.name, job.spec.method) != left,
    )
    made = snakemake(clone, "all", *([str(PAPER)] if HAS_LATEX else []), *SMOKE)
    assert made.returncode == 0, made.stdout[-4000:] + made.stderr[-4000:]
    return clone


def test_every_table_and_figure_is_there_and_traced(whole: Path) -> None:
    for names, kinds in ((TABLES, ("tex", "csv")), (PICTURES, ("pdf", "png"))):
        for name in names:
            for kind in kinds:
                lines = list(trace(whole / FIGURES / f"{name}.{kind}", whole))
                assert not [line for line in lines if line.endswith(("since)", "here)"))]


def test_a_second_call_for_everything_has_nothing_to_do(whole: Path) -> None:
    assert planned(whole, "all", *SMOKE) == {}


def test_the_page_is_whole(whole: Path) -> None:
    outline = Outline((whole / FIGURES / "report.html").read_text(encoding="utf-8"))
    inside = {link.removeprefix("#") for link in outline.links if link.startswith("#")}
    assert inside <= outline.ids.keys()
    beside = {link for link in outline.links if not link.startswith("#")}
    assert all((whole / FIGURES / link).is_file() for link in beside)
    assert {*TABLES, *PICTURES, "champion-hopper"} <= outline.ids.keys()
    assert all(source.startswith("data:image/") for source in outline.sources)


def test_snakemake_reports_with_captions(whole: Path) -> None:
    made = snakemake(whole, "--report", "snakemake.html", "tables", "figures", *SMOKE)
    assert made.returncode == 0, made.stderr
    (caption,) = [each.caption for each in EXHIBITS if each.name == "figure2"]
    assert json.dumps(caption)[1:-1] in (whole / "snakemake.html").read_text()


@NEEDS_LATEX
def test_the_paper_is_short_and_refers_to_what_is_there(whole: Path) -> None:
    log = (whole / "build/rare_mutation/smoke/paper/reproduction.log").read_text(errors="replace")
    written = re.search(r"Output written on .*\((\d+)\s+pages", log.replace("\n", ""))
    assert written
    assert 7 <= int(written[1]) <= 12
    assert "undefined" not in log


@NEEDS_LATEX
def test_the_paper_comes_out_the_same_again(whole: Path) -> None:
    before = hashlib.sha256((whole / PAPER).read_bytes()).hexdigest()
    shutil.rmtree(whole / "build/rare_mutation/smoke/paper")
    made = snakemake(whole, str(PAPER), *SMOKE)
    assert made.returncode == 0, made.stderr
    assert hashlib.sha256((whole / PAPER).read_bytes()).hexdigest() == before


@NEEDS_LATEX
def test_latex_works_for_some_tasks_of_a_budget(tmp_path: Path) -> None:
    """The folder's name has a comma, which LaTeX reads as a list; a failed build leaves no file."""
    folder = tmp_path / "demo-cartpole,lunar_lander"
    folder.mkdir()
    text, numbers, output = (
        tmp_path / "reproduction.tex", folder / "results.tex", tmp_path / "out.pdf",
    )  # fmt: skip
    text.write_text("\\documentclass{article}\\input{results}\\begin{document}\\x\\end{document}")
    command = [ROOT / "paper/build.sh", text.name, numbers.relative_to(tmp_path), output.name]
    numbers.write_text("\\newcommand{\\x}{\\undefined}")
    assert subprocess.run(command, cwd=tmp_path, capture_output=True).returncode == 1
    numbers.write_text("\\newcommand{\\x}{7}")
    made = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert made.returncode == 0, made.stdout
    assert output.exists()


def test_without_latex_the_paper_says_what_to_install(whole: Path, tmp_path: Path) -> None:
    for tool in ("bash", "dirname", "env"):
        (tmp_path / tool).symlink_to(shutil.which(tool) or "")
    command = ["paper/build.sh", "paper/reproduction.tex", "build/results.tex", "out.pdf"]
    ran = subprocess.run(
        command, cwd=whole, env={"PATH": str(tmp_path)}, capture_output=True, text=True
    )
    assert ran.returncode == 1
    assert re.fullmatch(r"neol: out\.pdf needs LaTeX.*apt install latexmk .*\n", ran.stderr)
    assert not (whole / "out.pdf").exists()
