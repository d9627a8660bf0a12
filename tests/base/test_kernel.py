"""The cache of compiled kernels."""

import os
import pwd
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from neol.base.kernel import UNUSED_SECONDS, _cache_folder, kernel, source_digest

COMPILE = (
    "import numba; from neol.network.forward import activate; activate(1.0, 0); "
    "print(numba.config.CACHE_DIR)"
)


def cache_of_a_process(**environment: str) -> Path:
    """Compile a kernel in its own process; return the folder of its cache."""
    done = subprocess.run(
        [sys.executable, "-c", COMPILE],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return Path(done.stdout.strip())


@pytest.mark.slow
def test_kernels_are_cached_under_the_digest_of_their_sources(tmp_path: Path) -> None:
    folder = cache_of_a_process(NUMBA_CACHE_DIR=str(tmp_path))
    assert folder == tmp_path / f"kernels-{source_digest()}"
    assert list(folder.rglob("forward.activate-*.nbc"))


@pytest.mark.slow
def test_a_cache_that_cannot_be_written_is_made_elsewhere_and_found_again(tmp_path: Path) -> None:
    blocked = tmp_path / "a file"
    blocked.touch()
    places = {
        cache_of_a_process(NUMBA_CACHE_DIR=str(blocked), TMPDIR=str(tmp_path)) for _ in range(2)
    }
    assert places == {tmp_path / f"neol-{os.getuid()}" / f"kernels-{source_digest()}"}


@pytest.mark.parametrize("mode", [0o720, 0o702])
def test_a_cache_that_others_can_write_is_not_read(
    mode: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    temporary = tmp_path / f"neol-{os.getuid()}" / f"kernels-{source_digest()}"
    for base in (tmp_path, temporary.parent):
        folder = base / temporary.name
        folder.mkdir(parents=True)
        folder.chmod(mode)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert _cache_folder().name.startswith("neol-kernels-")
    temporary.chmod(0o700)
    assert _cache_folder() == temporary


def test_a_cache_of_another_user_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(os, "getuid", lambda: tmp_path.stat().st_uid + 1)
    assert _cache_folder().name.startswith("neol-kernels-")


def test_an_unknown_user_without_a_home_has_a_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(pwd, "getpwuid", {}.__getitem__)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert _cache_folder().parent == tmp_path / f"neol-{os.getuid()}"


@pytest.mark.slow
def test_long_unused_caches_are_removed(tmp_path: Path) -> None:
    old, recent = tmp_path / "kernels-old", tmp_path / "kernels-recent"
    for folder in (old, recent):
        folder.mkdir()
    past = time.time() - UNUSED_SECONDS - 1
    os.utime(old, (past, past))
    cache_of_a_process(NUMBA_CACHE_DIR=str(tmp_path))
    assert not old.exists()
    assert recent.exists()


def test_a_kernel_keeps_its_plain_twin() -> None:
    @kernel
    def double(x: float) -> float:
        """Twice as much."""
        return 2 * x

    assert double(3.0) == double.py_func(3.0) == 6.0  # type: ignore[attr-defined]


CALLS = """
from numba.core import serialize

unpickle, calls = serialize._numba_unpickle, []
serialize._numba_unpickle = lambda *arguments: calls.append(arguments) or unpickle(*arguments)

from neol.run.runner import evolve
from neol.spec.configuration import load_configuration

for task in ("cartpole", "lunar_lander", "bipedal_walker", "hopper"):
    evolve(
        load_configuration("smoke").run_spec(
            task=task, method="bcm", population=8, learning_rate=0.25, generations=3
        )
    )
print(len(calls))
"""


@pytest.mark.slow
def test_no_kernel_calls_python_for_what_it_returns() -> None:
    """Numba does not expect an exception there, but a signal handler may raise one."""
    done = subprocess.run(
        [sys.executable, "-c", CALLS], stdout=subprocess.PIPE, text=True, check=True
    )
    assert done.stdout == "0\n"
