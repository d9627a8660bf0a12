import ctypes

import numpy as np
import numpy.typing as npt

from neol.base.c_calls import address, call_int, call_void
from neol.base.kernel import kernel


@kernel
def copy(memcpy: int, target: npt.NDArray[np.float64], source: npt.NDArray[np.float64]) -> None:
    call_void(memcpy, target, source, 8 * len(source))


@kernel
def absolute(abs_: int, value: int) -> int:
    return call_int(abs_, np.int32(value))


def test_calls_by_address() -> None:
    libc = ctypes.CDLL(None)
    target, source = np.zeros(3), np.array([1.5, 2.5, 3.5])
    copy(address(libc.memcpy), target, source)
    assert target.tolist() == source.tolist()
    assert absolute(address(libc.abs), -5) == 5
