"""The cache of compiled kernels."""

import errno
import os
import pwd
import stat
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest

from neol.base.kernel import c_function, kernel
from neol.base.kernel_cache import MARK, UNUSED_SECONDS, kernel_folder, source_digest

COMPILE = (
    "import numba; from neol.network.forward import activate; activate(1.0, 0); "
    "print(numba.config.CACHE_DIR)"
)


def _name() -> str:
    """The name of the folder that is chosen, without what chance makes of it."""
    folder = kernel_folder()
    assert folder is not None
    return folder.name[: len("neol-kernels-")]


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
        cache_of_a_process(
            NUMBA_CACHE_DIR=str(blocked), XDG_CACHE_HOME=str(blocked), TMPDIR=str(tmp_path)
        )
        for _ in range(2)
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
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "no" / "such"))
    (tmp_path / "no").touch()
    assert _name() == "neol-kernels-"
    temporary.chmod(0o700)
    assert kernel_folder() == temporary


@pytest.mark.parametrize("mode", [0o770, 0o707])
def test_a_cache_whose_parent_others_can_write_is_not_read(
    mode: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shared = tmp_path / "shared"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(shared / "below"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    own = tmp_path / "home" / "neol" / f"kernels-{source_digest()}"
    shared.mkdir()
    shared.chmod(mode)
    assert kernel_folder() == own
    shared.chmod(mode | stat.S_ISVTX)
    assert kernel_folder() == shared / "below" / own.name
    assert stat.S_IMODE((shared / "below").stat().st_mode) == 0o700


def test_a_link_to_a_folder_that_others_can_write_is_not_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "shared" / "below").mkdir(parents=True)
    (tmp_path / "shared").chmod(0o777)
    (tmp_path / "link").symlink_to(tmp_path / "shared" / "below")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "link"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    assert kernel_folder() == tmp_path / "home" / "neol" / f"kernels-{source_digest()}"


def treble(x: float) -> float:
    """Three times as much."""
    return 3 * x


def compiled_kernel() -> tuple[float, int]:
    """Compile a kernel; return its result for 2 and how often it was found in the cache."""
    compiled: Any = kernel(treble)
    return compiled(2.0), sum(compiled.stats.cache_hits.values())


def compiled_c_function() -> tuple[float, int]:
    """Compile a C function; return its result for 2 and how often it was found in the cache."""
    compiled = c_function(treble, numba.float64(numba.float64))
    return compiled.ctypes(2.0), compiled.cache_hits


both_kinds = pytest.mark.parametrize("compiled", [compiled_kernel, compiled_c_function])
Compiled = Callable[[], tuple[float, int]]


@pytest.fixture
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder in which this process keeps what it compiles."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    return tmp_path


def full(*_: object, **__: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


@both_kinds
@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize("size", [0, 100])
def test_a_damaged_cache_is_compiled_again_and_replaced(
    compiled: Compiled, suffix: str, size: int, kernels: Path
) -> None:
    assert compiled() == (6.0, 0)
    assert compiled() == (6.0, 1)
    (file,) = kernels.rglob(f"*{suffix}")
    os.truncate(file, size)
    assert compiled() == (6.0, 0)
    assert compiled() == (6.0, 1)


@both_kinds
def test_a_damaged_cache_that_cannot_be_replaced_costs_time_and_not_the_work(
    compiled: Compiled, kernels: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled()
    (index,) = kernels.rglob("*.nbi")
    os.truncate(index, 100)
    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile._open_for_write", full)
    assert compiled() == (6.0, 0)


@both_kinds
def test_a_full_disk_costs_time_and_not_the_work(
    compiled: Compiled, kernels: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile._open_for_write", full)
    assert compiled() == (6.0, 0)
    assert not any(path.is_file() for path in kernels.rglob("*"))


def test_a_disk_without_any_place_for_a_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("neol.base.kernel_cache._make_private", full)
    monkeypatch.setattr(tempfile, "mkdtemp", full)
    assert kernel_folder() is None


def test_a_cache_of_another_user_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(os, "getuid", lambda: tmp_path.stat().st_uid + 1)
    assert _name() == "neol-kernels-"


def test_an_unknown_user_without_a_home_has_a_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(pwd, "getpwuid", {}.__getitem__)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = kernel_folder()
    assert folder is not None
    assert folder.parent == tmp_path / f"neol-{os.getuid()}"


@pytest.mark.slow
def test_long_unused_caches_are_removed(tmp_path: Path) -> None:
    old, recent, foreign = (tmp_path / f"kernels-{name}" for name in ("old", "recent", "foreign"))
    for folder in (old, recent, foreign):
        folder.mkdir()
        if folder != foreign:
            (folder / MARK).touch()
    past = time.time() - UNUSED_SECONDS - 1
    for folder in (old, foreign):
        os.utime(folder, (past, past))
    cache_of_a_process(NUMBA_CACHE_DIR=str(tmp_path))
    assert not old.exists()
    assert recent.exists()
    assert foreign.exists()


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
