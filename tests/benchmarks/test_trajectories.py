"""What the benchmark compares is the same work: recorded episodes come out the same."""

import shutil

import numpy as np
import pytest

from benchmarks.networks import CONNECTIONS, HIDDEN, join, large
from benchmarks.trajectories import Recording, record, seconds_of_gymnasium
from neol.random.seeds import episode_seeds
from neol.rollout import make_engine
from neol.spec.configuration import load_configuration

pytestmark = pytest.mark.slow  # two worlds of its own are compiled


@pytest.fixture(scope="module")
def recording() -> Recording:
    spec = load_configuration("smoke").run_spec(
        task="cartpole", method="bcm", population=5, learning_rate=2.5, generations=1, seed=0
    )
    engine = make_engine(spec.task, "fast")
    return record(
        spec.task, engine, large(spec, (4, 2), 5), episode_seeds(0, 1, 5, 1), spec.plasticity
    )


def test_a_recording_holds_every_step(recording: Recording) -> None:
    log = recording.log
    assert log.row[0] == recording.steps + len(recording.seeds) == len(log.reward)
    assert sum(len(outputs) for _, outputs in recording.episodes()) == recording.steps
    assert log.ended.sum() == (recording.rollouts.steps < recording.task.max_steps).sum()


def test_playing_back_is_the_same_work_as_playing(recording: Recording) -> None:
    played = recording.play_back("bcm")
    assert np.array_equal(played.weight, recording.rollouts.weight)
    assert np.array_equal(played.threshold, recording.rollouts.threshold)
    assert np.array_equal(played.steps, recording.rollouts.steps)
    assert not np.array_equal(recording.networks.weight, recording.rollouts.weight)


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("rule", ["hebb", "oja", "bcm"])
def test_the_loop_in_c_gives_the_same_bits(recording: Recording, rule: str) -> None:
    from benchmarks import c_loop

    assert np.array_equal(c_loop.play_back(recording, rule), recording.play_back(rule).weight)


def test_gymnasium_is_stepped_through_the_same_episodes(recording: Recording) -> None:
    assert seconds_of_gymnasium(recording) > 0.0


def test_large_networks_are_as_large_as_is_said() -> None:
    spec = load_configuration("smoke").run_spec(
        task="cartpole", method="neat", population=5, learning_rate=None, generations=1, seed=0
    )
    networks = large(spec, (4, 2), 3)
    assert np.diff(networks.edge_bounds).tolist() == [CONNECTIONS] * 3
    assert np.diff(networks.node_offset).tolist() == [HIDDEN + 2] * 3
    for node in range(HIDDEN + 2):
        sources = networks.source[networks.edge_offset[node] : networks.edge_offset[node + 1]]
        assert len(set(sources.tolist())) == len(sources)
        assert (sources < 4 + min(node, HIDDEN)).all()


def test_joined_batches_hold_the_networks_in_order() -> None:
    spec = load_configuration("smoke").run_spec(
        task="cartpole", method="neat", population=5, learning_rate=None, generations=1, seed=0
    )
    networks = large(spec, (4, 2), 3)
    joined = join([networks.slice(0, 1), networks.slice(1, 3)])
    assert np.array_equal(joined.node_offset, networks.node_offset)
    assert np.array_equal(joined.edge_offset, networks.edge_offset)
    assert np.array_equal(joined.weight, networks.weight)
