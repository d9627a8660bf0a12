"""The compiled core for tests; with a compiler it must be built."""

import ctypes

import pytest

from neol.rollout.worlds.box2d.build import BuildError, build, find_compiler
from neol.rollout.worlds.box2d.library import load


def require_compiler() -> None:
    """Skip the test without a C++ compiler."""
    try:
        find_compiler()
    except BuildError as error:
        pytest.skip(str(error))


def require_core() -> ctypes.CDLL:
    """Return an up-to-date core; the test fails if it cannot be built."""
    require_compiler()
    library = load()
    if isinstance(library, str):
        build()
        library = load()
    assert isinstance(library, ctypes.CDLL), library
    return library
