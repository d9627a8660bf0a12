"""The interface of an engine, which plays episodes and updates weights (paper's Algorithm 2)."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from neol.network.forward import Networks
from neol.network.plasticity import Learning, compiled
from neol.spec.constants import Plasticity


@dataclass(frozen=True, slots=True)
class Rollouts:
    """Results of P networks with N episodes each."""

    returns: npt.NDArray[np.float64]
    """float64[P, N]: sum of each episode's rewards; NaN from the first failed episode on."""
    steps: npt.NDArray[np.int64]
    """int64[P, N]: environment steps of each episode."""
    weight: npt.NDArray[np.float64]
    """float64[E]: weights at the end of each network's last episode."""
    threshold: npt.NDArray[np.float64]
    """float64[M]: sliding thresholds at the end of the last episode; 0 without a rule."""
    failed: npt.NDArray[np.bool_]
    """bool[P]: whether an observation, a weight or a sum of rewards was not finite."""

    @classmethod
    def begin(cls, networks: Networks, seeds: npt.NDArray[np.uint64]) -> "Rollouts":
        """Return the state before the first step, with copies of the weights."""
        return cls(
            returns=np.full(seeds.shape, np.nan),
            steps=np.zeros(seeds.shape, dtype=np.int64),
            weight=networks.weight.copy(),
            threshold=np.zeros_like(networks.bias),
            failed=np.zeros(len(seeds), dtype=np.bool_),
        )


@runtime_checkable
class Engine(Protocol):
    """Player of one task's episodes; results do not depend on which engine plays."""

    name: str

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        """Play one episode for each network and each of its seeds, uint64[P, N], in order.

        With write-back an episode starts from the final weights of the one before it, without it
        from the inherited weights. Thresholds start every episode at 0.
        """
        ...

    def close(self) -> None:
        """Release the engine's environments."""
        ...


def learning_of(plasticity: Plasticity, threshold: npt.NDArray[np.float64]) -> Learning:
    """Return the learning of networks with these thresholds. Raises UserError for unknown rules."""
    return Learning(
        rule=compiled(plasticity.rule),
        gain=plasticity.learning_rate * plasticity.reward_scale,
        threshold_rate=plasticity.threshold_rate,
        weight_limit=plasticity.weight_limit,
        threshold=threshold,
    )
