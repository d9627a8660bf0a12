"""Champions replay exactly the episodes of their records."""

from pathlib import Path

import numpy as np
import pytest

from neol.base.errors import UserError
from neol.champions.player import load_champion
from neol.spec.configuration import ROOT
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import RESULTS
from tests.champions.conftest import MakePlayer, MakeRecord

TASKS = ["cartpole", "lunar_lander", "hopper", "bipedal_walker", "gym:Pendulum-v1"]
DEMO = sorted((ROOT / RESULTS / DEFAULT_READING / "demo").rglob("neat*/*/seeds_000-*.parquet"))
DEMO += sorted((ROOT / RESULTS / DEFAULT_READING / "demo").rglob("bcm/*/seeds_000-*.parquet"))


@pytest.mark.parametrize("task", TASKS)
def test_the_return_is_the_recorded_one(task: str, player_of: MakePlayer) -> None:
    player = player_of(task)
    for seed, recorded in zip(player.held_out_seeds, player.recorded_returns, strict=True):
        trace = player.play(seed)
        assert trace.episode_return == recorded
        assert sum(trace.rewards.tolist()) == recorded
    assert player.evaluate(player.held_out_seeds).tolist() == list(player.recorded_returns)


@pytest.mark.slow
@pytest.mark.parametrize("record", DEMO, ids=lambda path: "-".join(path.parts[-4:-1]))
def test_shipped_champions_replay(record: Path) -> None:
    player = load_champion(record, 2)
    traces = [player.play(seed) for seed in player.held_out_seeds[:2]]
    assert [trace.episode_return for trace in traces] == list(player.recorded_returns[:2])


def test_a_trace_has_every_step(player_of: MakePlayer) -> None:
    player = player_of("cartpole")
    network, trace = player.network, player.play(player.held_out_seeds[0])
    steps = len(trace)
    assert trace.observations.shape == (steps, network.inputs)
    assert trace.activities.shape == (steps, len(network.bias))
    assert trace.weights.shape == (steps + 1, len(network.weight))
    assert trace.thresholds.shape == (steps + 1, len(network.bias))
    assert (trace.weights[0] == network.weight).all()
    assert (trace.thresholds[0] == 0).all()
    assert (trace.thresholds[1:] > 0).all()
    assert (trace.weights[1:] != trace.weights[:-1]).any(axis=1).all(), "learns in each step"
    assert (trace.actions == trace.activities[:, -network.outputs :].argmax(axis=1)).all()


def test_plasticity_can_stop_in_mid_episode(player_of: MakePlayer) -> None:
    player = player_of("cartpole")
    seed = player.held_out_seeds[0]
    plastic, frozen = player.play(seed), player.play(seed, plastic_steps=3)
    assert (frozen.weights[:4] == plastic.weights[:4]).all()
    assert (frozen.weights[3:] == frozen.weights[3]).all()
    assert (plastic.weights[4] != plastic.weights[3]).any()


def test_a_champion_is_found_by_its_seed(record_of: MakeRecord) -> None:
    record = record_of("cartpole")
    assert load_champion(record).spec.seed == 3
    assert load_champion(record, 4).spec.seed == 4
    assert load_champion(record, 4).held_out_seeds != load_champion(record, 3).held_out_seeds
    with pytest.raises(UserError, match="has no seed 5; its seeds are 3, 4"):
        load_champion(record, 5)


def test_an_episode_that_fails_at_once_has_an_empty_trace(player_of: MakePlayer) -> None:
    player = player_of("gym:Pendulum-v1")

    class Broken:
        def watch(self, *_: object) -> float:
            return np.nan

    trace = player.play(0, engine=Broken())  # type: ignore[arg-type]
    assert len(trace) == 0
    assert trace.observations.shape == (0, 3)
    assert trace.weights.shape == (1, len(player.network.weight))
    assert np.isnan(trace.episode_return)
