"""Weights and biases: drawing and mutating them (paper's Algorithm 4)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel
from neol.random.pcg64 import State, next_double, standard_normals


class ValueRates(NamedTuple):
    """Constants of drawing and mutating weights, or biases."""

    init_sd: float
    limit: float
    mutate_rate: float
    replace_rate: float
    mutate_power: float


@kernel
def mutate_values(values: npt.NDArray[np.float64], rates: ValueRates, random: State) -> None:
    """Perturb or replace some weights or biases in place (lines 22-27)."""
    if rates.mutate_rate + rates.replace_rate == 0.0:
        return
    noise = standard_normals(len(values), random)
    for i in range(len(values)):
        chance = next_double(random)
        perturbed, fresh = values[i] + rates.mutate_power * noise[i], rates.init_sd * noise[i]
        changed = _clip(perturbed if chance < rates.mutate_rate else fresh, rates.limit)
        if chance < rates.mutate_rate + rates.replace_rate:
            values[i] = changed


@kernel
def draw_values(values: npt.NDArray[np.float64], rates: ValueRates, random: State) -> None:
    """Draw all weights or biases: normal with mean 0, clipped to their limit."""
    noise = standard_normals(len(values), random)
    for i in range(len(values)):
        values[i] = _clip(rates.init_sd * noise[i], rates.limit)


@kernel
def _clip(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
