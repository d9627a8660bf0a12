import ctypes

import pytest

from tests.helpers.core import require_compiler, require_core


@pytest.fixture(scope="session")
def compiler() -> None:
    require_compiler()


@pytest.fixture(scope="session")
def library() -> ctypes.CDLL:
    return require_core()
