"""The command line, called as a user would."""

import os
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from neol.cli import app
from neol.run import runner
from neol.spec.configuration import ROOT
from neol.spec.run_spec import RunSpec

TINY = (
    "--task cartpole --method oja --population 6 --learning-rate 0.25 --generations 3 "
    "--engine reference --set evaluation.held_out_episodes=3 --max-steps 40 "
)


def neol(line: str, *arguments: object) -> Result:
    """Call neol in this process with the words of a line, then whole arguments such as paths."""
    return CliRunner().invoke(app, [*shlex.split(line), *map(str, arguments)])


def refused(arguments: str) -> str:
    """Return the one line that a command with wrong input prints."""
    outcome = neol(arguments)
    assert outcome.exit_code == 2
    assert outcome.stdout == ""
    assert outcome.stderr.startswith("neol: ")
    assert outcome.stderr.count("\n") == 1
    return outcome.stderr


def specification(
    arguments: str, monkeypatch: pytest.MonkeyPatch
) -> tuple[RunSpec, dict[str, Any]]:
    """Return the run that a command specifies, without running it."""
    called: list[tuple[RunSpec, dict[str, Any]]] = []

    def pretend(spec: RunSpec, seeds: list[int], output: Path, **settings: Any) -> Any:
        called.append((spec, {"seeds": seeds, "output": output, **settings}))
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "run_block", pretend)
    assert neol(arguments).exit_code == 130
    return called[0]


def start(arguments: str, folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "neol", *shlex.split(arguments)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A test run in the background ignores SIGINT, and its children would inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
