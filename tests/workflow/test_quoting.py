"""Arguments of shells are quoted: a path or a name is never a command."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT
from tests.workflow.clone import SMOKE, fresh_clone, snakemake

HOSTILE = 'it\'s $(touch PWNED) "here"'
"""Name of a folder with characters that shells and make interpret."""
RULES = [ROOT / "Snakefile", *sorted((ROOT / "rules").glob("*.smk"))]
SHELL = re.compile(r'^ +shell:\n((?: +".*"\n)+)', re.MULTILINE)
QUOTED = re.compile(r"\{(?:(?:input|output|params|log)(?:\.\w+)?:q|params\.arguments|threads)\}")
"""`arguments` are words that shlex has quoted."""


@pytest.mark.parametrize("path", RULES, ids=lambda path: path.name)
def test_every_rule_quotes_what_it_fills_in(path: Path) -> None:
    text = path.read_text()
    commands = SHELL.findall(text)
    assert len(commands) == len(re.findall(r"^ +shell:$", text, re.MULTILINE))
    for command in commands:
        assert not re.findall(r"\{[^}]*\}", QUOTED.sub("", command))


def test_make_works_in_a_folder_of_any_name(tmp_path: Path) -> None:
    folder = tmp_path / HOSTILE
    programs = folder / ".venv" / "bin"
    programs.mkdir(parents=True)
    for name in (
        "environment.lock",
        "build.lock",
        "pyproject.toml",
        ".venv/.environment",
        ".venv/.ready",
    ):
        (folder / name).touch()
    (folder / "Makefile").write_bytes((ROOT / "Makefile").read_bytes())
    for name in ("snakemake", "mkdocs", "jupyter", "ruff", "mypy", "snakefmt", "pytest", "python"):
        (programs / name).write_text(f'#!/bin/sh\necho {name} "$@" >> called\n')
        (programs / name).chmod(0o700)
    targets = ["figures/table1.tex", "report", "docs", "lab", "check", "test", "bench"]
    subprocess.run(["make", "--silent", *targets], cwd=folder, check=True)
    called = (folder / "called").read_text().split("\n")
    assert "snakemake figures/table1.tex" in called
    assert "python -m benchmarks.run" in called
    assert not list(tmp_path.rglob("PWNED"))


@pytest.mark.slow
def test_the_workflow_works_in_a_folder_of_any_name(tmp_path: Path) -> None:
    clone = fresh_clone(tmp_path / HOSTILE)
    environment = clone / "environment"
    environment.symlink_to(sys.prefix)
    program = str(environment / "bin" / Path(sys.executable).name)
    record = "results/rare_mutation/smoke/cartpole/neat/p006/seeds_000-002.parquet"
    for target in ([record, *SMOKE], ["figures/table3.tex"]):
        result = subprocess.run(
            [program, "-m", "snakemake", *target],
            cwd=clone,
            env=os.environ | {"PYTHONPATH": str(clone)},
            capture_output=True,
            text=True,
        )
        assert result.returncode == 0, result.stderr
        assert (clone / target[0]).exists()
    assert not list(clone.rglob("PWNED"))


@pytest.mark.slow
def test_a_folder_with_a_brace_is_refused_in_a_line(tmp_path: Path) -> None:
    clone = fresh_clone(tmp_path / "a{b}c")
    result = snakemake(clone, "figures/table3.tex")
    assert result.returncode == 1
    (line,) = (line for line in result.stderr.splitlines() if "neol:" in line)
    assert line.endswith("below a name with a brace; rename it")
    assert "Traceback" not in result.stderr
