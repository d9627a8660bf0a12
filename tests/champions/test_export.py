"""Exported networks compute what ours compute."""

import json
import math
import sys
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
import pytest

from neol.base.errors import UserError
from neol.champions import export as exports
from neol.champions.export import Exported, Node, export, to_json
from neol.champions.onnx_export import to_onnx
from neol.champions.player import Player, Trace
from neol.rollout.environment import make_environment
from neol.spec.configuration import ROOT
from tests.champions.conftest import MakePlayer

TASKS = ["cartpole", "lunar_lander", "hopper", "bipedal_walker", "gym:Pendulum-v1"]
CASES = [(task, "tanh") for task in TASKS] + [
    ("lunar_lander", activation) for activation in ("relu", "sigmoid", "identity")
]


def episode(player: Player) -> Trace:
    """Return observations of an episode, and the outputs of the network with fixed weights."""
    return player.play(player.held_out_seeds[0], plastic_steps=0)


def outputs_of(player: Player, trace: Trace) -> npt.NDArray[np.float64]:
    return trace.activities[:, -player.network.outputs :]


@pytest.mark.slow
@pytest.mark.parametrize(("task", "activation"), CASES)
def test_the_json_says_all_that_is_needed(
    task: str, activation: str, player_of: MakePlayer
) -> None:
    """Another reader of the format, written from its documentation alone, gives the same bits."""
    player = player_of(task, "bcm", activation)
    trace = episode(player)
    content = json.loads(to_json(player))
    assert Exported.model_validate_json(to_json(player)) == export(player)
    functions = {
        "tanh": math.tanh,
        "relu": lambda total: max(total, 0.0),
        "sigmoid": lambda total: 1.0 / (1.0 + math.exp(-total)),
        "identity": lambda total: total,
    }
    expected = outputs_of(player, trace)
    for observation, outputs, action in zip(
        trace.observations, expected, trace.actions, strict=True
    ):
        values = observation.tolist()
        for node in content["nodes"]:
            total = node["bias"]
            for source, weight in zip(node["sources"], node["weights"], strict=True):
                total += values[source] * weight
            total = max(-content["sum_limit"], min(content["sum_limit"], total))
            total *= content["activation_scale"]
            values.append(functions[node["activation"]](total))
        found = values[-len(content["outputs"]) :]
        assert found == outputs.tolist()
        how = content["action"]
        if how["kind"] == "discrete":
            assert how["start"] + np.argmax(found) == action
        else:
            clipped = np.clip(found, how["low"], how["high"]).astype(how["dtype"])
            assert np.array_equal(clipped, action)


@pytest.mark.parametrize(("task", "activation"), CASES)
def test_onnx_gives_the_same_actions(task: str, activation: str, player_of: MakePlayer) -> None:
    onnx = pytest.importorskip("onnx")
    from onnx.reference import ReferenceEvaluator

    player = player_of(task, "bcm", activation)
    model = onnx.load_from_string(to_onnx(player))
    assert {entry.key: entry.value for entry in model.metadata_props}["seed"] == "3"
    _check(ReferenceEvaluator(model).run, player)


@pytest.mark.parametrize(("task", "activation"), CASES)
def test_onnxruntime_gives_the_same_actions(
    task: str, activation: str, player_of: MakePlayer
) -> None:
    pytest.importorskip("onnx")
    runtime = pytest.importorskip("onnxruntime")
    player = player_of(task, "bcm", activation)
    _check(runtime.InferenceSession(to_onnx(player)).run, player)


def _check(run: Any, player: Player) -> None:
    """Outputs agree to 1e-12 in a batch of all of an episode's observations, actions wholly."""
    trace = episode(player)
    outputs, action = run(["outputs", "action"], {"observation": trace.observations})
    np.testing.assert_allclose(outputs, outputs_of(player, trace), rtol=0, atol=1e-12)
    assert action.dtype == trace.actions.dtype
    assert np.array_equal(action, trace.actions)


def test_onnx_is_optional(player_of: MakePlayer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "onnx", None)
    with pytest.raises(UserError, match="needs the package onnx: pip install onnx"):
        to_onnx(player_of("cartpole"))


def test_bounds_are_finite_and_no_others(
    player_of: MakePlayer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """JSON knows no infinity, and outputs are within +-1 anyway."""
    player = player_of("gym:Pendulum-v1")
    with make_environment(player.spec.task) as world:
        world.action_space = gymnasium.spaces.Box(
            np.array([-np.inf, 0.5]), np.array([2.0, np.inf]), dtype=np.float64
        )
        monkeypatch.setattr(exports, "make_environment", lambda _: world)
        action = export(player).action.model_dump()
    assert action == {
        "kind": "continuous", "low": (-1.0, 0.5), "high": (1.0, 1.0), "dtype": "float64"
    }  # fmt: skip


def test_the_document_names_every_key_of_the_json() -> None:
    text = (ROOT / "docs" / "how-to" / "watch-a-champion.md").read_text(encoding="utf-8")
    for model in (Exported, Node):
        for key in model.model_fields:
            assert f"`{key}`" in text
