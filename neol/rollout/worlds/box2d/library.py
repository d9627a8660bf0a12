"""The compiled core as a shared library: its path, its sources, and loading it."""

import ctypes
import hashlib
import os
import platform
import sys
from pathlib import Path

from neol.base.errors import UserError

FOLDER = Path(__file__).parent
LIBRARY = FOLDER / f"core.{'dylib' if sys.platform == 'darwin' else 'so'}"
LOCK = FOLDER / "box2d.lock"

FLAGS = (
    "-std=c++17",
    "-O3",
    "-ffp-contract=off",  # fused multiply-adds would round differently from Gymnasium's Box2D
    "-fno-access-control",  # our solver reads the private state of Box2D's worlds
    "-fPIC",
    "-fvisibility=hidden",
)

LANES = {
    "x86_64": (
        ("-DNEOL_LANES=sse2",),
        ("-DNEOL_LANES=avx2", "-mavx2", "-mfma"),
        ("-DNEOL_LANES=avx512", "-mfma", "-mavx512f", "-mavx512vl", "-mavx512dq"),
    ),
    "aarch64": (("-DNEOL_LANES=neon",),),
}.get({"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine()), ())
"""Flags for each kind of vector of this processor family; the core detects those available."""

TASKS = ("LunarLander-v3", "BipedalWalker-v3", "BipedalWalkerHardcore-v3")
"""Gymnasium ids in the order of the core's numbers for them."""
PATHS = ("plain", "shortcut", "sse2", "avx2", "avx512", "neon")
"""Algorithms with equal results, in the order of the core's numbers for them (lockstep.hpp)."""
SLOTS = {"plain": 1, "shortcut": 1, "sse2": 8, "avx2": 16, "avx512": 32, "neon": 8}
"""Best number of worlds held at once, by path: two vectors of them, if the path uses vectors."""
PATH_VARIABLE = "NEOL_BOX2D_PATH"
"""Environment variable that sets the path."""


def stamp() -> str:
    """Return a digest of all that makes a library: our sources, Box2D's lock, the flags."""
    digest = hashlib.sha256(repr((FLAGS, LANES)).encode())
    for pattern in ("*.lock", "*.?pp", "stub/**/*.h"):
        for path in sorted(FOLDER.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def load(path: Path = LIBRARY) -> ctypes.CDLL | str:
    """Return the core with its functions declared, or one phrase on why there is none.

    A stale library is never opened, because the stamp is a string in its file.
    """
    if not path.exists():
        return "its C++ core is not built (python -m neol.rollout.worlds.box2d.build)"
    if stamp().encode() not in path.read_bytes():
        return "its C++ core is out of date (python -m neol.rollout.worlds.box2d.build)"
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        return f"its C++ core cannot be loaded: {error}"
    pointer, number = ctypes.c_void_p, ctypes.c_int
    for name, result, arguments in (
        ("neol_stamp", ctypes.c_char_p, []),
        ("neol_available", ctypes.c_bool, [number]),
        ("neol_best_path", number, []),
        ("neol_create", pointer, [number, number, number]),
        ("neol_destroy", None, [pointer]),
        ("neol_reset", None, [pointer, ctypes.c_int64, pointer, pointer]),
        ("neol_step", None, [pointer, ctypes.c_int64, *[pointer] * 5]),
        ("neol_physics", None, [pointer, pointer, number, number]),
    ):
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


def available_paths(library: ctypes.CDLL) -> list[str]:
    """Return the paths that this machine supports."""
    return [name for number, name in enumerate(PATHS) if library.neol_available(number)]


def chosen_path(library: ctypes.CDLL) -> str:
    """Return the fastest path, or the one that the variable NEOL_BOX2D_PATH names.

    Raises UserError if this machine does not support that path.
    """
    path = os.environ.get(PATH_VARIABLE) or PATHS[library.neol_best_path()]
    available = available_paths(library)
    if path not in available:
        raise UserError(
            f'{PATH_VARIABLE}: no path "{path}" on this machine; choose {", ".join(available)}'
        )
    return path
