"""The workflow's plans and refusals, before anything has run."""

import os
import random
import re
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from neol.run.workspace import finished_path, partial_folder
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import RESULTS, blocks, paper_cells
from neol.study.campaign.jobs import jobs
from neol.study.campaign.multiverse import calls
from neol.study.campaign.shown import DEFAULT_BUDGET, select
from neol.study.output.sidecar import trace
from tests.workflow.clone import FIGURES, SMOKE, fresh_clone, planned, snakemake

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a clone as after `git clone`: no .snakemake/, files of any age."""
    clone = fresh_clone(tmp_path_factory.mktemp("plan") / "neol")
    chance = random.Random(0)
    for path in clone.rglob("*"):
        age = chance.uniform(0, 1e9)
        os.utime(path, (age, age), follow_symlinks=False)
    return clone


def missing(clone: Path, records: Iterable[Path]) -> int:
    """Count the records that are not shipped."""
    return sum(not (clone / record).exists() for record in records)


def test_everything_of_the_papers_budget(clone: Path) -> None:
    records = [job.record for job in jobs(select("paper"))]
    plan = planned(clone, "all", "--config", "budget=paper")
    assert plan["run"] == missing(clone, records)
    assert sum(rule.endswith("_notebook") for rule in plan) == 9


def test_table_1_of_the_papers_budget_needs_only_the_papers_configurations(clone: Path) -> None:
    paper = select("paper")
    cells = paper_cells(paper, table=3).values()
    records = [RESULTS / block.record for block in blocks(paper) if block.cell in cells]
    runs = missing(clone, records)
    target = "figures/paper/table1.tex"
    assert planned(clone, target, "--config", "budget=paper") == {"run": runs, "tables_notebook": 1}


DEMO = ("tables", "figures", "claims", "--config", "budget=demo")
NOTEBOOKS = {
    f"{name}_notebook": 1
    for name in ("tables", "efficiency", "ablation", "convergence", "heatmaps", "claims")
}


@contextmanager
def edited(path: Path, old: str, new: str) -> Iterator[None]:
    """Change a file's text for a while."""
    before = path.read_text()
    assert old in before
    path.write_text(before.replace(old, new))
    try:
        yield
    finally:
        path.write_text(before)


def test_shipped_records_are_used_as_they_are(clone: Path) -> None:
    assert planned(clone, *DEMO) == NOTEBOOKS


def test_some_tasks_of_a_budget_need_only_their_runs(clone: Path) -> None:
    assert planned(clone, *DEMO, "tasks=cartpole") == NOTEBOOKS
    records = [RESULTS / block.record for block in blocks(select("paper", "cartpole"))]
    plan = planned(clone, "records", "--config", "budget=paper", "tasks=cartpole")
    assert plan.get("run", 0) == missing(clone, records)


def test_tables_of_some_tasks_say_so(clone: Path) -> None:
    options = ("--config", "budget=demo", "tasks=cartpole")
    target = "figures/demo-cartpole/table1.tex"
    made = snakemake(clone, target, *options)
    assert made.returncode == 0, made.stderr
    assert "Budget demo, CartPole only: G = 60" in (clone / target).read_text()
    assert f"made by  snakemake {target} {' '.join(options)}" in trace(clone / target, clone)
    assert planned(clone, target, *options) == {}
    for source, repeated in (
        ("pictures/style.py", {}),
        ("study/workflow/status.py", {}),
        ("study/outcomes/campaign_runs.py", {"tables_notebook": 1}),
    ):
        with edited(clone / "neol" / source, '"""\n', '"""\n# other code\n'):
            assert planned(clone, target, *options) == repeated


def test_a_record_that_is_there_is_no_error_to_ask_for(clone: Path) -> None:
    record = str(RESULTS / blocks(select("demo"))[0].record)
    assert planned(clone, record, "--config", "budget=demo") == {}


def test_a_dry_run_changes_nothing(clone: Path) -> None:
    """A running campaign's files stay too: the seeds of a complete record."""
    record = clone / RESULTS / blocks(select("demo"))[0].record
    seed = finished_path(partial_folder(record), 0)
    seed.parent.mkdir()
    shutil.copy(record, seed)
    try:
        before = tree(clone / "results")
        assert planned(clone, *DEMO) == NOTEBOOKS
        assert tree(clone / "results") == before
    finally:
        shutil.rmtree(seed.parent, ignore_errors=True)


def tree(folder: Path) -> list[tuple[Path, int]]:
    """Return every file and folder below, with its time of change."""
    return [(path, path.stat().st_mtime_ns) for path in sorted(folder.rglob("*"))]


def test_a_deleted_record_is_the_only_run_planned(clone: Path) -> None:
    block = random.Random(1).choice(blocks(select("demo")))
    record = clone / RESULTS / block.record
    aside = record.rename(record.with_suffix(".aside"))
    try:
        assert planned(clone, *DEMO) == NOTEBOOKS | {"run": 1}
    finally:
        aside.rename(record)


@pytest.mark.parametrize(
    ("old", "new", "methods", "reason"),
    [
        (
            "elitism: 2 ",
            "elitism: 3 ",
            {"neat", "neat_wo", "hebb", "oja", "bcm"},
            "neat.elitism is 2 there and 3 here",
        ),
        (
            "{rule: hebb, weight_mutation: off}",
            "{rule: hebb, weight_mutation: 0.1}",
            {"hebb"},
            "neat.weight_mutation is 'off' there and 0.1 here",
        ),
    ],
)
def test_a_changed_constant_plans_the_runs_that_it_affects_and_says_why(
    old: str, new: str, methods: set[str], reason: str, clone: Path
) -> None:
    every = blocks(select("demo"))
    affected = [RESULTS / block.record for block in every if block.cell.method in methods]
    with edited(clone / "config" / "base.yaml", old, new):
        said = snakemake(clone, *DEMO, "--dry-run").stdout
    assert set(re.findall(r"^Job \d+: (.*)$", said, re.MULTILINE)) == {
        f"{record} is of another specification: {reason}" for record in affected
    }


def test_another_reading_shares_no_path_with_the_shown_one(clone: Path) -> None:
    options = "--config", "budget=demo", "reading=worked_example", "set=plasticity.reward_scale=0.1"
    reading = "worked_example+plasticity.reward_scale=0.1"
    said = snakemake(clone, "tables", *options, "--dry-run").stdout
    every = blocks(select("demo", reading=reading))
    assert set(re.findall(r"^Job \d+: (\S+) is missing$", said, re.MULTILINE)) == {
        str(RESULTS / block.record) for block in every
    }
    outputs = re.findall(r"^    output: (.*)$", said, re.MULTILINE)
    files = [file for line in outputs for file in line.split(", ")]
    assert all(f"/{reading}/demo/" in file for file in files)
    logs = re.findall(r"^    log: (\S+)$", said, re.MULTILINE)
    assert all(log.startswith(f"logs/{reading}/demo/") for log in logs)


def test_the_page_of_readings_needs_no_run(clone: Path) -> None:
    assert set(planned(clone, "docs/readings.md")) <= {"readings_page"}


def test_a_call_of_the_multiverse_plans_its_records(clone: Path) -> None:
    words = calls()[1].split()
    assert words[-1] == "reading=worked_example+plasticity.reward_scale=0.1"
    records = [Path(word) for word in words if word.endswith(".parquet")]
    assert planned(clone, *words).get("run", 0) == missing(clone, records)


def test_every_table_and_figure_is_a_target(clone: Path) -> None:
    names = [f"table{number}.{kind}" for number in range(1, 9) for kind in ("tex", "csv")]
    names += [f"figure{number}.{kind}" for number in range(2, 12) for kind in ("pdf", "png")]
    files = [str(FIGURES / name) for name in names]
    assert planned(clone, *files, *SMOKE) == planned(clone, "tables", "figures", *SMOKE)


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["tables", "--config", "budget=dusk"], 'unknown budget "dusk", did you mean "desk"?'),
        (
            ["tables", "--config", "bugdet=desk"],
            "--config bugdet: unknown key (allowed: budget, reading, set, tasks)",
        ),
        (["tables", "--config", "reading=frist"], 'unknown reading "frist", did you mean "first"?'),
        (
            ["tables", "--config", "reading=first,removal"],
            'unknown reading "first,removal"; give one reading',
        ),
        (
            ["tables", "--config", "set=neat.elitsm=3"],
            '--reading: neat.elitsm: unknown key, did you mean "elitism"?',
        ),
        (
            ["tables", "--config", "set=budget.seeds=3"],
            '"budget.seeds=3": a reading sets no budget',
        ),
        (
            ["tables", "--config", "budget=demo", "tasks=cartpole,hopper"],
            'budget demo has no task "hopper" (allowed: cartpole, lunar_lander)',
        ),
        (
            ["figures/table1.tex", "--config", "budget=paper"],
            "budget paper makes no such file, did you mean figures/paper/table1.tex?",
        ),
    ],
)
def test_what_cannot_be_made_is_refused_in_one_line(
    clone: Path, arguments: list[str], line: str
) -> None:
    result = snakemake(clone, "--dry-run", *arguments)
    (said,) = [text for text in result.stderr.splitlines() if not text.startswith("Using workflow")]
    assert result.returncode != 0
    assert said.startswith("neol: ")
    assert line in said


@pytest.mark.parametrize(
    "arguments",
    [
        ["figures/paper/claims.tex"],
        [f"results/{DEFAULT_READING}/{DEFAULT_BUDGET}/cartpole/nix.parquet"],
    ],
)
def test_what_is_not_of_what_is_shown_has_no_rule(clone: Path, arguments: list[str]) -> None:
    result = snakemake(clone, "--dry-run", *arguments)
    assert result.returncode != 0
    assert f"No rule to produce {arguments[0]}" in result.stdout


def test_it_may_be_asked_from_another_folder(clone: Path, tmp_path: Path) -> None:
    arguments = "--snakefile", str(clone / "Snakefile"), *DEMO
    assert planned(tmp_path, *arguments, code=clone) == NOTEBOOKS
    assert list(tmp_path.iterdir()) == []


def test_no_record_is_deleted_with_all_output(clone: Path) -> None:
    records = sorted((clone / "results").rglob("*.parquet"))
    page = clone / "figures" / "demo" / "report.html"
    page.parent.mkdir(parents=True, exist_ok=True)
    page.touch()
    result = snakemake(clone, "all", "--config", "budget=demo", "--delete-all-output")
    assert result.returncode == 0, result.stderr
    assert not page.exists()
    assert sorted((clone / "results").rglob("*.parquet")) == records
