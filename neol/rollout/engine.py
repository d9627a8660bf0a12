"""What an engine is: it plays episodes and lets networks learn in them (paper's Algorithm 2)."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from neol.network.forward import Networks
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
