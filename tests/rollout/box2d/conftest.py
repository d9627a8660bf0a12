import ctypes

import pytest

from neol.rollout.box2d.build import BuildError, build, find_compiler
from neol.rollout.box2d.library import load


def require_compiler() -> None:
    try:
        find_compiler()
    except BuildError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def compiler() -> None:
    require_compiler()


@pytest.fixture(scope="session")
def library() -> ctypes.CDLL:
    require_compiler()
    build()
    library = load()
    assert isinstance(library, ctypes.CDLL), library
    return library
