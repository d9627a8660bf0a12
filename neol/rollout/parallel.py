"""Many workers on one population, with the same bits as one worker.

An episode is a function of its seed and network alone, so a batch may be cut anywhere.
"""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from functools import cache
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection

import numpy as np
import numpy.typing as npt

from neol.base.errors import UserError
from neol.base.interruption import ENDING, stop_if_asked
from neol.network.forward import Networks
from neol.rollout.engine import Engine, Rollouts
from neol.spec.constants import Plasticity

LOOK_SECONDS = 0.1
"""Interval at which the process that waits for workers checks whether to stop."""


def portions(networks: int, workers: int) -> list[tuple[int, int]]:
    """Cut a batch into pieces (begin, end), which free workers take in order.

    Episodes differ in length. The pieces shrink so that all workers end together: each is half of
    a worker's share of the rest (guided self-scheduling, Polychronopoulos & Kuck 1987).
    """
    pieces, begin = [], 0
    while begin < networks:
        half_share = (networks - begin) // (2 * workers)
        end = begin + max(half_share, 1)
        pieces.append((begin, end))
        begin = end
    return pieces


class ProcessEngine:
    """Engine that spreads a batch over processes, each with its own engine."""

    def __init__(self, make_engine: Callable[[], Engine], name: str, workers: int) -> None:
        self.name = name
        self._workers = workers
        _start_tracker()
        spawn = multiprocessing.get_context("spawn")
        closed, self._lifeline = spawn.Pipe(duplex=False)
        self._executor = ProcessPoolExecutor(
            workers,
            mp_context=spawn,
            initializer=_begin_worker,
            initargs=(make_engine, closed),
        )

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        try:
            futures = [
                self._executor.submit(
                    _evaluate, networks.slice(begin, end), seeds[begin:end], plasticity
                )
                for begin, end in portions(networks.population, self._workers)
            ]
            pending = set(futures)
            while pending:
                stop_if_asked()
                pending = wait(pending, LOOK_SECONDS).not_done
            parts = [future.result() for future in futures]
        except BrokenProcessPool:
            stop_if_asked()  # the signal may have ended a worker that had only begun
            raise UserError(
                "a worker process died (killed, or out of memory?); "
                "run again with --resume, perhaps with fewer --workers"
            ) from None
        return Rollouts(
            returns=np.concatenate([part.returns for part in parts]),
            steps=np.concatenate([part.steps for part in parts]),
            weight=np.concatenate([part.weight for part in parts]),
            threshold=np.concatenate([part.threshold for part in parts]),
            failed=np.concatenate([part.failed for part in parts]),
        )

    def close(self) -> None:
        self._lifeline.close()
        self._executor.shutdown(cancel_futures=True)


def _start_tracker() -> None:
    """Start multiprocessing's resource tracker so that it survives signals to the process group.

    It inherits the signals that are blocked here; by itself it ignores only Ctrl-C and SIGTERM.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        resource_tracker.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


_make_worker_engine: Callable[[], Engine]


def _begin_worker(make_engine: Callable[[], Engine], closed: Connection) -> None:
    global _make_worker_engine
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)  # sent to the whole group; the parent handles it
    threading.Thread(target=_end_with_engine, args=(closed,), daemon=True).start()
    _make_worker_engine = cache(make_engine)


def _end_with_engine(closed: Connection) -> None:
    """End the worker, even during an episode, when the engine is closed or its process killed."""
    closed.poll(None)  # until the other end of the pipe is closed
    os._exit(1)


def _evaluate(
    networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
) -> Rollouts:
    """Evaluate a piece. The engine is made here, because an initializer could not report errors."""
    return _make_worker_engine().evaluate(networks, seeds, plasticity)
