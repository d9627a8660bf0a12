"""Where compiled kernels are kept."""

import os
import subprocess
import sys
import time
from pathlib import Path

from neol.kernel import UNUSED_SECONDS, kernel, source_digest

COMPILE = (
    "import numba; from neol.plasticity import hebb; hebb(1.0, 2.0); print(numba.config.CACHE_DIR)"
)


def cache_of_a_process(**environment: str) -> Path:
    """Compile a kernel in a process of its own; where it is kept."""
    done = subprocess.run(
        [sys.executable, "-c", COMPILE],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return Path(done.stdout.strip())


def test_kernels_are_cached_under_the_digest_of_their_sources(tmp_path: Path) -> None:
    folder = cache_of_a_process(NUMBA_CACHE_DIR=str(tmp_path))
    assert folder == tmp_path / f"kernels-{source_digest()}"
    assert list(folder.rglob("plasticity.hebb-*.nbc"))


def test_a_cache_that_cannot_be_written_is_made_elsewhere_and_found_again(tmp_path: Path) -> None:
    blocked = tmp_path / "a file"
    blocked.touch()
    places = {
        cache_of_a_process(NUMBA_CACHE_DIR=str(blocked), TMPDIR=str(tmp_path)) for _ in range(2)
    }
    assert places == {tmp_path / f"neol-{os.getuid()}" / f"kernels-{source_digest()}"}


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
