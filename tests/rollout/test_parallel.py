"""Pieces of a batch for many workers, and the workers' end on a signal."""

import multiprocessing
import os
import signal
import time
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neol.base.interruption import Terminated, interruptible
from neol.rollout import EngineName, make_engine
from neol.rollout.parallel import ProcessEngine, portions
from tests.helpers.networks import random_networks
from tests.helpers.runs import SPEC


@given(networks=st.integers(0, 400), workers=st.integers(1, 70))
def test_portions_cover_a_batch_in_order(networks: int, workers: int) -> None:
    bounds = [0, *(end for _, end in portions(networks, workers))]
    assert portions(networks, workers) == list(pairwise(bounds))
    assert bounds[-1] == networks


def test_portions_shrink_towards_the_end() -> None:
    sizes = [end - begin for begin, end in portions(50, 2)]
    assert sizes == [12, 9, 7, 5, 4, 3, 2, 2, 1, 1, 1, 1, 1, 1]


@pytest.mark.parametrize("engine_name", ["reference", "fast"])
@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_every_engine_stops_when_it_is_asked(engine_name: EngineName, workers: int) -> None:
    networks = random_networks(np.random.default_rng(0), 1, 4, 2)
    with closing(make_engine(SPEC.task, engine_name, workers)) as engine, interruptible():
        signal.raise_signal(signal.SIGTERM)
        with pytest.raises(Terminated):
            engine.evaluate(networks, np.zeros((1, 1), dtype=np.uint64), SPEC.plasticity)


@dataclass
class Terminating:
    """An engine of a worker that has its parent terminated, and is at work for long then."""

    finished: Path
    name = "terminating"

    def evaluate(self, *_: object) -> NoReturn:
        os.kill(os.getppid(), signal.SIGTERM)
        time.sleep(30)
        self.finished.touch()
        raise AssertionError

    def close(self) -> None: ...


@pytest.mark.slow
def test_a_signal_waits_for_no_worker(tmp_path: Path) -> None:
    networks = random_networks(np.random.default_rng(0), 1, 4, 2)
    finished = tmp_path / "finished"
    engine = ProcessEngine(partial(Terminating, finished), "terminating", workers=2)
    with interruptible():
        with pytest.raises(Terminated):
            engine.evaluate(networks, np.zeros((1, 1), dtype=np.uint64), SPEC.plasticity)
        engine.close()
    assert not finished.exists()
    assert multiprocessing.active_children() == []
