"""What an engine is: it plays episodes and lets networks learn in them (paper's Algorithm 2)."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from neol.network.forward import Networks
from neol.network.plasticity import Learning, compiled
from neol.spec.constants import Plasticity


@dataclass(frozen=True, slots=True)
class Rollouts:
    """What P networks with N episodes each came to."""

    returns: npt.NDArray[np.float64]
    """float64[P, N]: sum of an episode's rewards; NaN from the episode that failed on."""
    steps: npt.NDArray[np.int64]
    """int64[P, N]: environment steps of each episode."""
    weight: npt.NDArray[np.float64]
    """float64[E]: the weights that each network's last episode ended with."""
    threshold: npt.NDArray[np.float64]
    """float64[M]: sliding thresholds at the end of the last episode; 0 without a rule."""
    failed: npt.NDArray[np.bool_]
    """bool[P]: an observation, a weight or a sum of rewards was not finite."""

    @classmethod
    def begin(cls, networks: Networks, seeds: npt.NDArray[np.uint64]) -> "Rollouts":
        """Before the first step, with weights of their own."""
        return cls(
            returns=np.full(seeds.shape, np.nan),
            steps=np.zeros(seeds.shape, dtype=np.int64),
            weight=networks.weight.copy(),
            threshold=np.zeros_like(networks.bias),
            failed=np.zeros(len(seeds), dtype=np.bool_),
        )


@runtime_checkable
class Engine(Protocol):
    """Plays episodes of one task; which engine plays never shows in a result."""

    name: str

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        """Let each network play one episode for each of its seeds, uint64[P, N], in order.

        With write-back an episode starts from the weights that the one before it ended with,
        without it from the inherited ones. Thresholds start every episode at 0.
        """
        ...

    def close(self) -> None:
        """Release the engine's environments."""
        ...


def learning_of(plasticity: Plasticity, threshold: npt.NDArray[np.float64]) -> Learning:
    """How networks with these thresholds learn. Raises UserError for an unknown rule."""
    return Learning(
        rule=compiled(plasticity.rule),
        gain=plasticity.learning_rate * plasticity.reward_scale,
        threshold_rate=plasticity.threshold_rate,
        weight_limit=plasticity.weight_limit,
        threshold=threshold,
    )
