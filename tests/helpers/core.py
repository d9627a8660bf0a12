"""The compiled core for tests: built where there is a compiler, and then it must be there."""

import ctypes

import pytest

from neol.rollout.worlds.box2d.build import BuildError, build, find_compiler
from neol.rollout.worlds.box2d.library import load


def require_compiler() -> None:
    """Skip the test where there is no C++ compiler."""
    try:
        find_compiler()
    except BuildError as error:
        pytest.skip(str(error))


def require_core() -> ctypes.CDLL:
    """The core, up to date; the test fails where it cannot be built."""
    require_compiler()
    library = load()
    if isinstance(library, str):
        build()
        library = load()
    assert isinstance(library, ctypes.CDLL), library
    return library
