"""Compilation of neol's kernels and C functions, with one cache."""

import contextlib
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numba.core.ccallback import CFunc
from numba.core.dispatcher import Dispatcher

from neol.base.kernel_cache import KernelCache, kernel_folder

PLAIN = bool(numba.config.DISABLE_JIT)  # type: ignore[attr-defined]
"""Whether kernels stay plain Python (NUMBA_DISABLE_JIT=1), to debug them: the same bits, slowly."""
if PLAIN:
    np.seterr(all="ignore")  # compiled code does not warn of overflows either

Function = TypeVar("Function", bound=Callable[..., object])

FOLDER = kernel_folder()
"""Where this process keeps compiled kernels; None if there is no place for them."""
if FOLDER is not None:
    numba.config.CACHE_DIR = str(FOLDER)  # type: ignore[attr-defined]


def kernel(function: Function) -> Function:
    """Compile a function to machine code that releases the GIL, cached on disk.

    It uses neither fast math nor threads, so a kernel rounds as its Python source does. The source
    stays available as `function.py_func`, the plain twin that the tests compare with.

    A kernel that Python calls writes into given arrays and returns none: numba calls Python to
    make a returned array or tuple, and crashes if a signal handler (Ctrl-C) raises there.
    """
    return _compiled(function, in_loop=False)


def loop_kernel(function: Function) -> Function:
    """Compile a function as a `kernel` that allocates no array, for the loop over steps.

    It is inlined into its callers and counts no references to arrays, which its caller keeps alive.
    Numba would count them for every array of a NamedTuple at every use, which took half of a
    CartPole step.
    """
    return _compiled(function, in_loop=True)


def c_function(function: Callable[..., object], signature: Any, cached: bool = True) -> Any:
    """Compile a function with a C signature, to be called by its `address`.

    It is as safe from a bad cache as a kernel. Nothing is kept on disk if not `cached`.
    """
    types = signature.args, signature.return_type
    compiled = CFunc(function, types, locals={}, options={"error_model": "numpy"})
    if cached:
        _keep_on_disk(compiled, function)
    compiled.compile()
    return compiled


def record_dtype(dtype: np.dtype[np.void]) -> np.dtype[np.void]:
    """Return a dtype of the same bytes with fields that plain kernels can read as attributes."""
    return np.dtype((np.record, dtype)) if PLAIN else dtype


def _compiled(function: Function, in_loop: bool) -> Function:
    """Compile with both options set, because an omitted one is inherited from a caller."""
    options: dict[str, Any] = {"forceinline": in_loop, "_nrt": not in_loop}
    compiled = numba.njit(nogil=True, error_model="numpy", **options)(function)
    if isinstance(compiled, Dispatcher):
        _keep_on_disk(compiled, function)
    return cast(Function, compiled)


def _keep_on_disk(compiled: Any, function: Callable[..., object]) -> None:
    """Replace the cache of a compiled function, which numba's decorators would leave unguarded."""
    if FOLDER is not None:
        with contextlib.suppress(OSError, RuntimeError):  # numba finds no place for the files
            compiled._cache = KernelCache(function)  # type: ignore[no-untyped-call]
