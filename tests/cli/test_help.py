"""The help is complete, in order, and its examples work; shell completion."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from neol.cli import app
from neol.cli.application import COMMANDS, EXIT_CODES
from neol.network.rules import method_names
from neol.spec.configuration import ROOT, budgets
from neol.spec.readings import DEFAULT_READING
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.tables.paper_tables import table1
from tests.helpers.made_up import configuration, write_campaign

GROUP: Any = typer.main.get_command(app)
NAMES = GROUP.list_commands(None)
SHARED = {
    "--budget": "Budget ",
    "--output": "",
    "--quiet": "Print errors only.",
    "--seed": "",
    "--set": "Set any other constant; may be repeated.",
    "--workers": "Parallel workers; does not change results.",
}
"""Options that several commands share, and the beginning of their help."""


def page(command: str = "") -> str:
    """Return the help of a command, or of the application."""
    outcome = CliRunner().invoke(app, [*command.split(), "--help"], env={"COLUMNS": "80"})
    assert outcome.exit_code == 0
    return outcome.stdout


def examples(command: str) -> list[str]:
    """Return the examples in a command's help."""
    return re.findall(r"^ +neol (.*)$", page(command).replace("\\\n", " "), re.MULTILINE)


def test_the_help_lists_every_command_once() -> None:
    assert sorted(NAMES) == sorted(GROUP.commands)
    listed = re.findall(r"^  (\w+)  ", page().partition("Running:")[2], re.MULTILINE)
    assert listed == NAMES
    titles = [text for text in re.findall(r"^(\w+):$", page(), re.MULTILINE) if text != "Options"]
    assert titles == list(COMMANDS)


def test_the_help_cuts_no_summary() -> None:
    assert "..." not in page().partition("Running:")[2]


def test_the_help_names_the_exit_codes() -> None:
    text = " ".join(page().split())
    for code, meaning in EXIT_CODES.items():
        assert f"{code} {meaning}" in text


@pytest.mark.parametrize("command", ["run", "config"])
def test_the_help_names_the_default_reading(command: str) -> None:
    assert f"config/readings/; default: {DEFAULT_READING}." in " ".join(page(command).split())


def test_the_help_of_a_run_says_what_a_budget_and_a_method_are() -> None:
    text = " ".join(page("run").split())
    assert "hebb, oja, bcm, or RULE_mutated (a rule with weight mutation)." in text
    assert "Budget whose constants apply (held-out episodes, step limits); its grid is not" in text


def test_help_and_version() -> None:
    runner = CliRunner()
    assert runner.invoke(app, "", env={"COLUMNS": "80"}).stdout == page()
    version = runner.invoke(app, "--version").stdout
    assert re.fullmatch(r"neol (\d+\.\d+\.\d+|\(not installed\))\n", version)


@pytest.mark.slow
@pytest.mark.parametrize("command", ["", *NAMES])
def test_help_needs_nothing_heavy(command: str) -> None:
    script = (
        "import sys; from neol.cli import app\n"
        f"try: app([*{command.split()}, '--help'])\n"
        "except SystemExit: pass\n"
        "heavy = {'numpy', 'numba', 'gymnasium', 'mujoco', 'pyarrow', 'pandas', 'matplotlib'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, cwd=ROOT)


@pytest.mark.parametrize("command", NAMES)
def test_options_of_one_name_mean_the_same(command: str) -> None:
    described = re.findall(r"^  (--[\w-]+)(?:.*?)  +(\w.*)$", page(command), re.MULTILINE)
    for option, text in described:
        if option in SHARED:
            assert text.startswith(SHARED[option][: len(text)]), option


@pytest.mark.slow
def test_every_example_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run all examples in a folder with shipped records and one table."""
    made_up = configuration()
    write_campaign(tmp_path / "made_up", made_up, {})
    table1(Campaign(made_up, tmp_path / "made_up")).write(tmp_path / "figures")
    for campaign in ("rare_mutation/demo", "rare_mutation/two_by_two"):
        folder = Path("results", campaign)
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    for command in NAMES:
        assert examples(command), command
        for example in examples(command):
            outcome = CliRunner().invoke(app, shlex.split(example))
            assert outcome.exit_code == 0, (example, outcome.output, outcome.exception)


# --- Completion ---------------------------------------------------------------------------------


def completions(line: str) -> list[str]:
    """Return bash's completions of the last word of a line."""
    words = line.split(" ")
    done = subprocess.run(
        [sys.executable, "-c", "from neol.cli import app; app(prog_name='neol')"],
        env=os.environ
        | {
            "_NEOL_COMPLETE": "complete_bash",
            "COMP_WORDS": line,
            "COMP_CWORD": str(len(words) - 1),
            "PYTHONPATH": str(ROOT),
        },
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.split()


@pytest.mark.slow
def test_bash_completes_commands_options_and_values() -> None:
    assert completions("neol ma") == ["manifest"]
    assert completions("neol run --meth") == ["--method"]
    assert completions("neol run --method ") == method_names()
    assert completions("neol config --budget ") == budgets()


@pytest.mark.slow
def test_a_completion_script_is_shown() -> None:
    disabled = {"_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}  # any shell
    done = subprocess.run(
        [sys.executable, "-m", "neol", "--show-completion", "bash"],
        env=os.environ | disabled | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "complete -o default -F _neol_completion neol" in done.stdout
