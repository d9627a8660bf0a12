"""Network and plasticity in C, the reference for a kernel's time."""

import ctypes
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from benchmarks.trajectories import Recording

NUMBERS = {"none": 0, "hebb": 1, "oja": 2, "bcm": 3}
"""Numbers of the rules in loop.c."""
FLAGS = ("-O3", "-ffp-contract=off", "-fPIC", "-shared")


@cache
def library() -> ctypes.CDLL:
    """Compile and load benchmarks/loop.c for this process."""
    source = Path(__file__).with_name("loop.c")
    with tempfile.TemporaryDirectory() as folder:
        compiled = Path(folder) / "loop.so"
        subprocess.run(["cc", *FLAGS, str(source), "-o", str(compiled), "-lm"], check=True)
        return ctypes.CDLL(str(compiled))


def play_back(recording: Recording, rule: str) -> npt.NDArray[np.float64]:
    """Do `recording.play_back(rule)` in C; return the learned weights, float64[E]."""
    networks, plasticity, log = recording.networks, recording.plasticity, recording.log
    weight, threshold = networks.weight.copy(), np.zeros_like(networks.bias)
    values = np.empty(networks.inputs + int(np.diff(networks.node_offset).max()))

    def pointer(array: npt.NDArray[np.float64] | npt.NDArray[np.int64]) -> ctypes.c_void_p:
        return ctypes.c_void_p(array.ctypes.data)

    arguments = (
        ctypes.c_int64(networks.population),
        pointer(networks.node_offset),
        pointer(networks.bias),
        pointer(networks.edge_offset),
        pointer(networks.source),
        pointer(weight),
        pointer(threshold),
        ctypes.c_int64(networks.inputs),
        ctypes.c_double(networks.sum_limit),
        ctypes.c_int(NUMBERS[rule]),
        ctypes.c_double(plasticity.learning_rate * plasticity.reward_scale),
        ctypes.c_double(plasticity.threshold_rate),
        ctypes.c_double(plasticity.weight_limit),
        pointer(recording.rollouts.steps),
        pointer(log.observation),
        pointer(log.reward),
        pointer(values),
    )
    library().play_back(*arguments)
    return weight
