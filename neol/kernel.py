"""How every compiled function of neol is made: one decorator, one cache."""

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def kernel(function: Function) -> Function:
    """Compile a function to machine code that holds no GIL, cached on disk.

    No fast math and no threads inside: a kernel rounds as its Python source does. The source
    stays reachable as `function.py_func`, the plain twin that the tests compare with.
    """
    compile_ = numba.njit(cache=True, nogil=True, error_model="numpy")
    return cast(Function, compile_(function))


@cache
def source_digest() -> str:
    """Hex digest of all sources of neol that hold compiled code, and of the compiler's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        text = path.read_bytes()
        if b"neol.kernel" in text or b"numba" in text:
            digest.update(text)
    return digest.hexdigest()[:16]


def _cache_folder() -> Path:
    """A writable folder of this source digest's own.

    Numba asks only whether the file of a cached kernel has changed, not the files of the
    kernels that it calls; a folder for each state of the sources makes a stale kernel impossible.
    """
    default = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "neol"
    folder = Path(os.environ.get("NUMBA_CACHE_DIR", default)) / f"kernels-{source_digest()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    except OSError:
        pass
    return Path(tempfile.mkdtemp(prefix="neol-kernels-"))


numba.config.CACHE_DIR = str(_cache_folder())
