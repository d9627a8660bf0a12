"""Many workers on one population, with the same bits as one worker.

An episode is a function of its seed and network alone, so a batch may be cut anywhere.
"""

import multiprocessing
import signal
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from neol.errors import UserError
from neol.network import Networks
from neol.rollout.engine import Engine, Rollouts
from neol.spec import Plasticity

_CHUNKS_PER_WORKER = 8  # episodes differ in length, so small chunks keep all workers busy


class ThreadedEngine:
    """Spreads a batch over threads: for engines that hold no GIL and share no state."""

    def __init__(self, engine: Engine, workers: int) -> None:
        self.name = engine.name
        self._engine = engine
        self._workers = workers
        self._executor = ThreadPoolExecutor(workers)

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        return _spread(
            self._executor, self._workers, self._engine.evaluate, networks, seeds, plasticity
        )

    def close(self) -> None:
        self._executor.shutdown(cancel_futures=True)
        self._engine.close()


class ProcessEngine:
    """Spreads a batch over processes, each with an engine of its own."""

    def __init__(self, make_engine: Callable[[], Engine], name: str, workers: int) -> None:
        self.name = name
        self._workers = workers
        self._executor = ProcessPoolExecutor(
            workers,
            mp_context=multiprocessing.get_context("spawn"),
            initializer=_begin_worker,
            initargs=(make_engine,),
        )

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        try:
            return _spread(
                self._executor, self._workers, _evaluate_in_worker, networks, seeds, plasticity
            )
        except BrokenProcessPool:
            raise UserError(
                "a worker process died (killed, or out of memory?); "
                "run again with --resume, perhaps with fewer --workers"
            ) from None

    def close(self) -> None:
        self._executor.shutdown(cancel_futures=True)


_worker_engine: Engine


def _begin_worker(make_engine: Callable[[], Engine]) -> None:
    global _worker_engine
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    _worker_engine = make_engine()


def _evaluate_in_worker(
    networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
) -> Rollouts:
    return _worker_engine.evaluate(networks, seeds, plasticity)


def _spread(
    executor: Executor,
    workers: int,
    evaluate: Callable[[Networks, npt.NDArray[np.uint64], Plasticity], Rollouts],
    networks: Networks,
    seeds: npt.NDArray[np.uint64],
    plasticity: Plasticity,
) -> Rollouts:
    """Evaluate a batch in chunks and put the chunks together in order."""
    chunks = min(workers * _CHUNKS_PER_WORKER, len(networks))
    bounds = np.linspace(0, len(networks), chunks + 1).astype(int)
    futures = [
        executor.submit(evaluate, networks.slice(begin, end), seeds[begin:end], plasticity)
        for begin, end in pairwise(bounds)
    ]
    parts = [future.result() for future in futures]
    return Rollouts(
        returns=np.concatenate([part.returns for part in parts]),
        steps=np.concatenate([part.steps for part in parts]),
        weight=np.concatenate([part.weight for part in parts]),
        threshold=np.concatenate([part.threshold for part in parts]),
        failed=np.concatenate([part.failed for part in parts]),
    )
