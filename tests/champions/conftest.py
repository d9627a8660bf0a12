"""Records of tiny runs, made once for all tests."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from neol.champions.player import Player, load_champion
from neol.run.runner import run_block
from neol.spec.configuration import load_configuration

MakeRecord = Callable[..., Path]
MakePlayer = Callable[..., Player]


@pytest.fixture(scope="session")
def record_of(tmp_path_factory: pytest.TempPathFactory) -> MakeRecord:
    """Make a record of two short runs of a task and method, seeds 3 and 4, with many nodes."""

    @cache
    def make(task: str, method: str = "bcm", activation: str = "tanh") -> Path:
        changes = {
            "neat.add_node_rate": 0.9,
            "neat.add_connection_rate": 0.9,
            "network.hidden_activation": activation,
            "evaluation.held_out_episodes": 3,
        }
        configuration = load_configuration("paper", [f"{k}={v}" for k, v in changes.items()])
        spec = configuration.run_spec(
            task=task,
            method=method,
            population=8,
            learning_rate=None if method.startswith("neat") else 0.25,
            generations=6,
            seed=3,
        )
        task_spec = spec.task.model_copy(update={"max_steps": 40})
        path = tmp_path_factory.mktemp("champions") / f"{spec.method}.parquet"
        run_block(spec.model_copy(update={"task": task_spec}), [3, 4], path)
        return path

    return make


@pytest.fixture(scope="session")
def player_of(record_of: MakeRecord) -> MakePlayer:
    """Return the champion of the first of these runs."""
    return lambda *arguments: load_champion(record_of(*arguments))
