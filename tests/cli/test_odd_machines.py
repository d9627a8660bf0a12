"""Settings of a machine that have nothing to do with a run, and limits that end it in one line."""

import os
import resource
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from neol.cli.progress import Progress
from neol.run.record_file import read_record
from neol.spec.configuration import ROOT
from tests.helpers.command import TINY, neol
from tests.helpers.runs import killer, result

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("own_folder")]

ASCII = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
HOPPER = f"run {TINY.replace('cartpole', 'hopper')} --output a.parquet"
LANDER = f"run {TINY.replace('cartpole', 'lunar_lander')} --output a.parquet"


def ended(
    command: str, environment: dict[str, str], limit: Callable[[], None] | None = None
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "neol", *shlex.split(command)],
        env=os.environ | {"PYTHONPATH": str(ROOT)} | environment,
        preexec_fn=limit,
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize(
    ("command", "environment", "printed"),
    [
        pytest.param(HOPPER, {"MUJOCO_GL": "nonsense"}, "a.parquet: written", id="MUJOCO_GL"),
        pytest.param(
            HOPPER.replace("reference", "fast"),
            {"MUJOCO_GL": "nonsense"},
            "a.parquet: written",
            id="MUJOCO_GL-fast",
        ),
        pytest.param(LANDER, {"PYTHONWARNINGS": "error"}, "a.parquet: written", id="warnings"),
        pytest.param(f"run {TINY} --output a.parquet", ASCII, r" \xb1 ", id="ascii"),
    ],
)
def test_what_a_run_does_not_need_cannot_end_it(
    command: str, environment: dict[str, str], printed: str
) -> None:
    done = ended(command, environment)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False)
    assert printed in done.stdout


def test_pictures_need_no_backend() -> None:
    assert neol(f"run {TINY} --output a.parquet").exit_code == 0
    done = ended("show a.parquet", {"MPLBACKEND": "nonsense"})
    assert (done.returncode, done.stderr) == (0, "")
    assert Path("champion.png").exists()


def test_a_limit_of_files_ends_in_one_line() -> None:
    few = 12
    command = f"run {TINY} --workers 2 --quiet --output a.parquet"
    done = ended(command, {}, lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (few, few)))
    assert done.returncode == 2
    assert done.stderr.startswith("neol: Too many open files; raise that limit (ulimit -a) or use")
    assert done.stderr.count("\n") == 1


def test_plain_kernels_run_whole_to_the_same_bits() -> None:
    """From a checkpoint, too, whose arrays come out of a file."""
    command = f"run {TINY} --quiet --resume --checkpoint-every 1"
    command = command.replace("--generations 3", "--generations 6").replace("reference", "auto")
    assert neol(f"{command} --output compiled.parquet").exit_code == 0
    with pytest.MonkeyPatch.context() as patch:
        stop = killer(0, 3, KeyboardInterrupt)
        patch.setattr(Progress, "__call__", lambda _, *told: stop(*told))
        loud = command.replace("--quiet", "")
        assert neol(f"{loud} --output plain.parquet").exit_code == 130
    done = ended(f"{command} --output plain.parquet", {"NUMBA_DISABLE_JIT": "1"})
    assert (done.returncode, done.stderr.count("\n")) == (0, 1), done.stderr
    assert "the reference engine plays CartPole-v1: NUMBA_DISABLE_JIT keeps it" in done.stderr
    compiled, plain = (read_record(Path(f"{name}.parquet")) for name in ("compiled", "plain"))
    assert result(plain) == result(compiled)
