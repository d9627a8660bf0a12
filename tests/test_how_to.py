"""The how-to pages do what they say."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from neol.run.record_file import read_record
from neol.spec.configuration import ROOT
from neol.spec.readings import DEFAULT_READING
from neol.study.output.sidecar import trace
from tests.workflow.clone import fresh_clone

PAGES = ROOT / "docs" / "how-to"


def blocks(page: str, language: str) -> list[str]:
    """Return the code blocks of a page in one language."""
    text = (PAGES / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\b.*?\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def shell(commands: str, folder: Path, package: Path = ROOT) -> str:
    """Run commands in a folder, with this neol or another copy of it; return their output."""
    binaries = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": binaries, "PYTHONPATH": str(package)}
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", commands],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def apply(diff: str, folder: Path) -> None:
    """Make a page's changes; the changed lines occur once in their file."""
    for path, change in re.findall(r"^\+\+\+ b/(.*)\n@@\n((?:[-+ ].*\n)+?)(?=---|\Z)", diff, re.M):
        file, lines = folder / path, change.splitlines(keepends=True)
        old, new = ("".join(line[1:] for line in lines if line[0] in kept) for kept in (" -", " +"))
        before = file.read_text(encoding="utf-8")
        assert before.count(old) == 1, f"{path} has other lines than the page says"
        file.write_text(before.replace(old, new), encoding="utf-8")


@pytest.mark.slow
def test_the_outcomes_behind_a_number() -> None:
    (script,) = blocks("check-a-number.md", "python")
    printed = shell(f"python - <<'END'\n{script}END", ROOT)
    rows = re.findall(r"^.* (\d+)$", printed, re.MULTILINE)
    assert rows == ["10"] * 16, "two tasks of eight cells, each with ten seeds"


@pytest.mark.slow
def test_a_rule_in_a_script(tmp_path: Path) -> None:
    (script,), (commands,) = blocks("add-a-rule.md", "python"), blocks("add-a-rule.md", "bash")
    (tmp_path / "decaying.py").write_text(script)
    *_, digest = shell(commands, tmp_path).splitlines()
    record = read_record(tmp_path / "decaying.parquet")
    assert digest == f"0 {record.seeds[0].digest}"
    assert (record.spec.method, record.spec.plasticity.rule) == ("decaying_hebb",) * 2
    assert record.seeds[0].engine == "fast"
    run, _ = commands.split("python decaying.py digest")
    shell(run.replace("--output decaying", "--engine reference --output again"), tmp_path)
    (again,) = read_record(tmp_path / "again.parquet").seeds
    assert (again.engine, again.digest) == ("reference", record.seeds[0].digest)


@pytest.mark.slow
def test_a_rule_in_the_repository(tmp_path: Path) -> None:
    clone = fresh_clone(tmp_path / "neol")
    (script,) = blocks("add-a-rule.md", "python")
    (function,) = re.findall(r"^@neol\.(rule\ndef .*?)^$", script, re.MULTILINE | re.DOTALL)
    digest = "python -c 'from neol.base.kernel_cache import source_digest; print(source_digest())'"
    before = shell(digest, clone, clone)
    with (clone / "neol" / "network" / "rules.py").open("a") as file:
        file.write(f"\n\n@{function}")
    assert shell(digest, clone, clone) != before, "or a stale kernel could be found"
    asked = (
        "python -m neol run --help; python -m neol config --schema; "
        "python -m neol config --budget smoke --set 'budget.methods=[decaying_hebb]'; "
        "python -m neol.spec.configuration"
    )
    assert shell(asked, clone, clone).count("decaying_hebb") > 4
    assert "decaying_hebb" in (clone / "config" / "schema.json").read_text()


@pytest.mark.slow
def test_a_task_on_the_command_line(tmp_path: Path) -> None:
    shell(blocks("add-a-task.md", "bash")[0], tmp_path)
    task = read_record(tmp_path / "acrobot.parquet").spec.task
    assert (task.environment, task.max_steps) == ("Acrobot-v1", 200)


@pytest.mark.slow
def test_a_task_in_a_budget(tmp_path: Path) -> None:
    clone = fresh_clone(tmp_path / "neol")
    (budget,) = blocks("add-a-task.md", "yaml")
    (clone / "config" / "swing.yaml").write_text(budget)
    commands = blocks("add-a-task.md", "bash")[1].replace("snakemake", "snakemake --dry-run")
    printed = shell(commands, clone, clone)
    assert "environment: Acrobot-v1" in printed
    planned = set(re.findall(r"results/rare_mutation/swing/\S+\.parquet", printed))
    assert planned == {
        "results/rare_mutation/swing/acrobot/neat/p008/seeds_000-001.parquet",
        "results/rare_mutation/swing/acrobot/oja/p008_lr0.25/seeds_000-001.parquet",
    }


@pytest.mark.slow
def test_a_task_of_one_s_own(tmp_path: Path) -> None:
    (script,) = blocks("add-a-task.md", "python")
    (tmp_path / "lights.py").write_text(script)
    command = blocks("add-a-task.md", "bash")[2]
    *_, line = shell(command, tmp_path).splitlines()
    record = read_record(tmp_path / "lights.parquet")
    assert record.seeds[0].held_out.mean is not None and record.seeds[0].held_out.mean > 40
    again = command.replace("--output lights", "--workers 2 --output again")
    assert shell(again, tmp_path).splitlines()[-1] == line, "the workers know it too"


@pytest.mark.slow
def test_a_change_of_selection(tmp_path: Path) -> None:
    clone = fresh_clone(tmp_path / "neol")
    change, of_tests = blocks("change-selection.md", "diff")
    tests, runs = blocks("change-selection.md", "bash")
    run, digest = runs.splitlines()[0], "neol digest as-before.parquet"
    before = shell(f"{run}\n{digest}\nrm as-before.parquet", clone, clone).splitlines()[-1]
    apply(change, clone)
    apply(of_tests, clone)
    shell("python -m neol.spec.configuration", clone, clone)
    assert '"tournament"' in (clone / "config" / "schema.json").read_text(encoding="utf-8")
    shell(tests, clone, clone)
    assert "neat.tournament" in shell(runs, clone, clone)
    assert shell(digest, clone, clone).strip() == before
    assert shell("neol digest tournament.parquet", clone, clone).strip() != before


@pytest.mark.slow
def test_a_claim(tmp_path: Path) -> None:
    clone = fresh_clone(tmp_path / "neol")
    for name, entry in zip(("questions", "claims"), blocks("add-a-claim.md", "yaml"), strict=True):
        with (clone / "paper" / f"{name}.yaml").open("a", encoding="utf-8") as file:
            file.write(entry)
    (commands,) = blocks("add-a-claim.md", "bash")
    printed = shell(commands, clone, clone)
    assert "## best-cells-cartpole: not asked here" in printed
    assert "> matching or slightly edging the NEAT row (Section A.8.2)" in printed


@pytest.mark.slow
def test_a_figure(tmp_path: Path) -> None:
    clone = fresh_clone(tmp_path / "neol")
    page = "add-a-table-or-figure.md"
    (entry,), (cell,), (commands,) = (blocks(page, kind) for kind in ("diff", "python", "bash"))
    apply(entry, clone)
    notebook = clone / "notebooks" / "beyond.ipynb"
    content = json.loads(notebook.read_text(encoding="utf-8"))
    new = {"cell_type": "code", "id": "species", "metadata": {}, "source": cell}
    content["cells"].append(new | {"outputs": [], "execution_count": None})
    notebook.write_text(json.dumps(content), encoding="utf-8")
    printed = shell(commands, clone, clone)
    assert "/demo/lunar_lander/bcm/" in printed
    figure = clone / "figures" / "demo" / "beyond_species.pdf"
    assert not [line for line in trace(figure, clone) if line.endswith(("since)", "here)"))]


@pytest.mark.slow
def test_a_question_under_another_reading(tmp_path: Path) -> None:
    """Follow the page with runs of two generations, and make one of its tables."""
    clone = fresh_clone(tmp_path / "neol")
    budget, reading = blocks("ask-another-reading.md", "yaml")
    small = {"generations: 20": "generations: 2", "count: 5": "count: 2", "[50]": "[6]"}
    for said, less in small.items():
        assert said in budget
        budget = budget.replace(said, less)
    (clone / "config" / "landing.yaml").write_text(budget)
    (clone / "config" / "readings" / "rare_crossover.yaml").write_text(reading)
    look, ask, compare, own = blocks("ask-another-reading.md", "bash")

    printed = shell(look, clone, clone)
    assert "<   weight_mutate_rate: 0.1" in printed and ">   weight_mutate_rate: 0.8" in printed

    planned = shell(ask.replace("snakemake", "snakemake --dry-run"), clone, clone)
    changed = "worked_example+plasticity.reward_scale=0.1"
    cell = "landing/lunar_lander/hebb/p006_lr0.0025/seeds_5000-5001.parquet"
    for name in (DEFAULT_READING, changed):
        assert f"results/{name}/{cell}" in planned
    for place in ("landing", f"{changed}/landing"):
        for table in ("table1.md", "table5.csv", "table7.md"):
            assert f"figures/{place}/{table}" in planned

    record = f"results/{DEFAULT_READING}/{cell}"
    shell(f"snakemake --cores 1 {record} --config budget=landing", clone, clone)
    table, under = f"figures/{changed}/landing/table1.md", changed.replace("+", " set=")
    options = f"--cores 2 --config budget=landing reading={under}"
    shell(f"snakemake {table} {options}", clone, clone)
    assert "Reading worked_example+" in (clone / table).read_text(encoding="utf-8")
    printed = shell(compare.replace("p050", "p006"), clone, clone)
    assert re.search(r"plasticity.reward_scale +1\.0 +0\.1", printed), printed

    run, plan = own.replace(" 50 ", " 6 ").replace(" 20 ", " 2 ").split("snakemake")
    shell(f"{run}snakemake --dry-run{plan}", clone, clone)
    record = read_record(clone / "rare.parquet")
    assert (record.reading, record.spec.neat.crossover_rate) == ("rare_crossover", 0.25)
