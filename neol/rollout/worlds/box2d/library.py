"""The compiled core as a shared library: where it lies, what it must be made from, loading it."""

import ctypes
import hashlib
import sys
from pathlib import Path

FOLDER = Path(__file__).parent
LIBRARY = FOLDER / f"core.{'dylib' if sys.platform == 'darwin' else 'so'}"
LOCK = FOLDER / "box2d.lock"

FLAGS = (
    "-std=c++17",
    "-O3",
    "-ffp-contract=off",  # fused multiply-adds would round otherwise than Gymnasium's Box2D
    "-fno-access-control",  # the solver is ours, the worlds' private state is Box2D's
    "-fPIC",
    "-fvisibility=hidden",
)

TASKS = ("LunarLander-v3", "BipedalWalker-v3", "BipedalWalkerHardcore-v3")
"""Gymnasium ids in the order of the core's own numbers for them."""


def stamp() -> str:
    """Digest of all that a library is made from: our sources, the lock of Box2D's, the flags."""
    digest = hashlib.sha256(" ".join(FLAGS).encode())
    for pattern in ("*.lock", "*.?pp", "stub/**/*.h"):
        for path in sorted(FOLDER.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def load(path: Path = LIBRARY) -> ctypes.CDLL | str:
    """The core, its functions declared; or, in one phrase, why there is none to use.

    A stale library is not even opened: the stamp is a string in the file.
    """
    if not path.exists():
        return "its C++ core is not built (python -m neol.rollout.worlds.box2d.build)"
    if stamp().encode() not in path.read_bytes():
        return "its C++ core is out of date (python -m neol.rollout.worlds.box2d.build)"
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        return f"its C++ core cannot be loaded: {error}"
    pointer = ctypes.c_void_p
    library.neol_stamp.restype = ctypes.c_char_p
    library.neol_create.argtypes = [ctypes.c_int]
    library.neol_create.restype = pointer
    library.neol_destroy.argtypes = [pointer]
    library.neol_destroy.restype = None
    library.neol_reset.argtypes = [pointer, pointer, pointer]
    library.neol_step.argtypes = [pointer, pointer, pointer, pointer]
    library.neol_physics.argtypes = [pointer, pointer, ctypes.c_int, ctypes.c_int]
    library.neol_physics.restype = None
    return library
