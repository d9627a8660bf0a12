"""The fast engine: the paper's tasks in compiled code, bit for bit as the reference engine."""

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from typing import Protocol

import numpy as np
import numpy.typing as npt

from neol.base.interruption import stop_if_asked
from neol.base.kernel import PLAIN
from neol.network.forward import Networks
from neol.rollout.engine import Engine, Rollouts
from neol.rollout.episodes import Batch, Slots, World
from neol.rollout.worlds import WORLDS
from neol.spec.constants import Plasticity, Task


class Simulation(Protocol):
    """Owner of the memory that a world points to; the world is valid while its simulation lives."""

    @property
    def world(self) -> World: ...

    @property
    def slots(self) -> int:
        """Number of episodes that the world holds at once."""


class FastEngine:
    """Engine that plays whole batches without Python and the GIL, one simulation per thread."""

    name = "fast"

    def __init__(
        self, make_simulation: Callable[[], Simulation], max_steps: int, workers: int = 1
    ) -> None:
        self.make_simulation = make_simulation
        """Maker of one more simulation of the task."""
        self._max_steps = max_steps
        self._workers = workers
        self._executor = ThreadPoolExecutor(workers)  # starts its threads on demand
        self._of_thread = threading.local()

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        rollouts = Rollouts.begin(networks, seeds)
        batch = Batch.of(networks, seeds, plasticity, self._max_steps, rollouts)
        over = threading.Event()
        try:
            others = [
                self._executor.submit(self._play, batch, over) for _ in range(self._workers - 1)
            ]
            self._play(batch, over)
            for other in others:
                other.result()
        finally:
            over.set()  # after Ctrl-C no thread begins another call
        return rollouts

    def _play(self, batch: Batch, over: threading.Event) -> None:
        """Play in this thread; a free slot takes the next network of the batch."""
        if not hasattr(self._of_thread, "simulation"):
            self._of_thread.simulation = self.make_simulation()
        simulation = self._of_thread.simulation
        share = -(-batch.networks.population // self._workers)  # so that no worker takes all
        slots = Slots.empty(min(simulation.slots, share), batch.networks)
        while not over.is_set():
            stop_if_asked()
            simulation.world.play(batch, slots)
            if slots.used[0] == 0:
                break

    def close(self) -> None:
        self._executor.shutdown()
        self._of_thread = threading.local()


def fast_engine(task: Task, workers: int = 1) -> Engine | str:
    """Return the compiled engine of a task with a number of threads, or why there is none."""
    if task.environment not in WORLDS:
        return "only the reference engine plays it"
    if PLAIN:
        return "NUMBA_DISABLE_JIT keeps it from being compiled"
    module = import_module(f"neol.rollout.worlds.{WORLDS[task.environment]}")
    make_simulation: Callable[[], Simulation] | str = module.simulations(task)
    if isinstance(make_simulation, str):
        return make_simulation
    return FastEngine(make_simulation, task.max_steps, workers)
