"""The boundary to environments: values that pass, and values refused in one line."""

import sys
from collections.abc import Iterator
from decimal import Decimal
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box, Discrete

from neol.base.errors import UserError
from neol.rollout import make_engine
from neol.rollout.environment import Environment, _notice, make_environment, network_size
from neol.spec.constants import Task
from tests.helpers import troubled
from tests.helpers.networks import random_networks
from tests.helpers.refusal import refusal
from tests.helpers.runs import SPEC

TASK = Task(name="strange", environment="Strange-v0", max_steps=9, fresh_world=False)
STEP = {"observation": np.zeros(2), "reward": 1.0, "terminated": False, "truncated": False}


class Strange(gymnasium.Env[Any, Any]):
    """Environment that returns or raises what a test sets."""

    action_space: Any = Discrete(2)

    def __init__(self, **told: Any) -> None:
        self.told = told
        if "space" in told:
            self.observation_space = told["space"]
        if "make" in told:
            told["make"]()

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        return self.told.get("reset", (np.zeros(2), {}))

    def step(self, action: Any) -> Any:
        if "step" in self.told:
            self.told["step"]()
        return *({**STEP, **self.told}[name] for name in STEP), self.told.get("info", {})

    def close(self) -> None:
        if "close" in self.told:
            self.told["close"]()


@pytest.fixture(autouse=True)
def _no_environment_stays() -> Iterator[None]:
    yield
    gymnasium.registry.pop(TASK.environment, None)


def strange(space: gymnasium.Space[Any] | None = None, **told: Any) -> Environment:
    register(space=space or Box(-1.0, 1.0, (2,), np.float64), **told)
    return Environment(TASK)


def register(**told: Any) -> None:
    gymnasium.register(TASK.environment, Strange, kwargs=told)


def failing(error: BaseException) -> Any:
    def fail() -> None:
        raise error

    return fail


@pytest.mark.parametrize(
    ("told", "said"),
    [
        (
            {"observation": np.zeros(3)},
            r"the observation .* of float64, shape \(3,\)\), not",
        ),
        (
            {"observation": np.zeros(1)},
            r"the observation .* of float64, shape \(1,\)\), not",
        ),
        ({"observation": np.zeros((1, 2))}, r"the observation .*shape \(1, 2\)\), not Box"),
        ({"observation": 0.5}, r"the observation 0.5 \(float\), not Box\(-1.0, 1.0, \(2,\)"),
        ({"observation": np.zeros(2, complex)}, r"the observation .* of complex128"),
        ({"observation": None}, r"the observation None"),
        ({"observation": {"x": 1}}, r"the observation {'x': 1} \(dict\)"),
        ({"observation": ["0", "1"]}, r"the observation \['0', '1'\] \(list\)"),
        (
            {"observation": [[1], [2, 3]]},
            r"the observation \[\[1\], \[2, 3\]\] \(list\): ValueError",
        ),
        (
            {"observation": np.zeros(2), "space": Box(0, 9, (2,), np.int64)},
            "the observation .*not Box",
        ),
        ({"reward": "1.0"}, r"the reward '1.0' \(str\), not a number"),
        ({"reward": None}, r"the reward None \(NoneType\), not a number"),
        ({"reward": 1j}, r"the reward 1j \(complex\), not a number"),
        ({"reward": np.ones(1)}, r"the reward array\(\[1.\]\)"),
        ({"reward": Decimal(1)}, r"the reward Decimal"),
        ({"terminated": "false"}, r"terminated = 'false' \(str\), not True or False"),
        ({"terminated": np.array([True, False])}, "terminated = array"),
        ({"truncated": np.array([False])}, "truncated = array"),
        ({"truncated": 0}, r"truncated = 0 \(int\), not True or False"),
        ({"info": None}, "the info None"),
    ],
)
def test_what_no_step_may_return_is_refused(told: dict[str, Any], said: str) -> None:
    environment = strange(**{"reset": (np.zeros(2, int), {}), **told})
    environment.reset(seed=7)
    with pytest.raises(UserError, match=f"^Strange-v0 returned {said}") as refused:
        environment.step(0)
    assert "(in step 1 of the episode with seed 7); fix it" in str(refused.value)


@pytest.mark.parametrize(
    ("returned", "said"),
    [
        (np.array([0.1, 0.2]), "returned from reset array"),
        ((0.1, 0.2), "returned the info 0.2"),
        ((np.zeros(3), {}), "returned the observation array"),
        (None, "returned from reset None"),
    ],
)
def test_what_no_reset_may_return_is_refused(returned: object, said: str) -> None:
    """The first two are an old `reset`, which returns two numbers as an observation."""
    said = rf"Strange-v0 {said}.*\(in reset of the episode with seed 7\)"
    with pytest.raises(UserError, match=said):
        strange(reset=returned).reset(seed=7)


@pytest.mark.parametrize(
    ("told", "observation", "reward", "done"),
    [
        ({}, [0.0, 0.0], 1.0, False),
        ({"observation": [0.1, 0.2]}, [0.1, 0.2], 1.0, False),
        ({"observation": np.ones(2, np.float32)}, [1.0, 1.0], 1.0, False),
        ({"observation": np.ones(2, np.uint8)}, [1.0, 1.0], 1.0, False),
        ({"observation": np.full(2, 5.0)}, [5.0, 5.0], 1.0, False),
        ({"observation": np.array([np.inf, 0.0])}, [np.inf, 0.0], 1.0, False),
        ({"reward": np.float32(0.1)}, [0.0, 0.0], float(np.float32(0.1)), False),
        ({"reward": np.array(2)}, [0.0, 0.0], 2.0, False),
        ({"reward": True}, [0.0, 0.0], 1.0, False),
        ({"terminated": np.True_}, [0.0, 0.0], 1.0, True),
        ({"truncated": np.array(True)}, [0.0, 0.0], 1.0, True),
    ],
)
def test_what_means_the_same_passes(
    told: dict[str, Any], observation: list[float], reward: float, done: bool
) -> None:
    environment = strange(**told)
    environment.reset(seed=7)
    seen, got, over = environment.step(0)
    assert (seen.tolist(), got, over) == (observation, reward, done)
    assert type(got) is float
    assert type(over) is bool


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (RuntimeError("no\nluck"), "raised RuntimeError: no luck"),
        (NotImplementedError(), "raised NotImplementedError"),
        (SystemExit(3), "raised SystemExit: 3"),
    ],
)
def test_what_a_step_raises_is_said_with_its_place(error: BaseException, said: str) -> None:
    environment = strange(step=failing(error))
    environment.reset(seed=7)
    line = refusal(environment.step, 0)
    assert line.startswith(f"Strange-v0 {said} (in step 1 of the episode with seed 7); fix it")


def test_ctrl_c_within_an_environment_is_ctrl_c() -> None:
    environment = strange(step=failing(KeyboardInterrupt()))
    environment.reset(seed=7)
    with pytest.raises(KeyboardInterrupt):
        environment.step(0)


def test_an_environment_that_cannot_be_closed_has_done_its_work(
    capsys: pytest.CaptureFixture[str],
) -> None:
    _notice.cache_clear()
    environment = strange(close=failing(RuntimeError("cannot close viewer")))
    environment.close()
    environment.close()
    line = "neol: note: Strange-v0 raised RuntimeError: cannot close viewer as it was closed\n"
    assert capsys.readouterr().err == line


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ({"make": failing(KeyError("HOME"))}, r"Strange-v0 cannot be made: KeyError: 'HOME'"),
        (
            {"make": failing(NotImplementedError())},
            "cannot be made: NotImplementedError",
        ),
        ({"make": lambda: sys.exit(3)}, "Strange-v0 cannot be made: SystemExit: 3"),
        ({}, "Strange-v0 cannot be made: AttributeError: .*observation_space"),
        ({"space": Box(-1, 1, (0,))}, "a network needs a flat Box"),
        ({"space": Discrete(5)}, "a network needs a flat Box"),
    ],
)
def test_what_cannot_be_made_is_refused(told: dict[str, Any], said: str) -> None:
    register(**told)
    with pytest.raises(UserError, match=f"^task strange: .*{said}"):
        make_environment(TASK)


def test_network_size_is_that_of_the_spaces() -> None:
    register(space=Box(-1.0, 1.0, (2,), np.float64))
    assert network_size(TASK) == (2, 2)


@pytest.mark.slow
def test_a_worker_says_why_it_has_no_environment() -> None:
    """A worker lacks an environment that only the main script registers."""
    register(space=Box(-1.0, 1.0, (2,), np.float64))
    networks, seeds = (
        random_networks(np.random.default_rng(0), 2, 2, 2),
        np.zeros((2, 1), np.uint64),
    )
    engine = make_engine(TASK, workers=2)
    said = refusal(engine.evaluate, networks, seeds, SPEC.plasticity)
    engine.close()
    assert said.startswith("task strange: no environment Strange-v0")


@pytest.mark.slow
def test_workers_check_what_environments_return(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(troubled.TROUBLE, str(tmp_path / "trouble"))
    (tmp_path / "trouble").write_text("shorten")
    networks, seeds = random_networks(np.random.default_rng(0), 2, 3, 2), np.arange(2000)
    engine = troubled.make_engine(troubled.TASK, "reference", workers=2)
    said = refusal(
        engine.evaluate, networks, seeds.reshape(2, -1).astype(np.uint64), SPEC.plasticity
    )
    engine.close()
    assert "Troubled-v0 returned the observation array" in said
    assert "shape (2,)), not Box" in said
    assert "(in step 3 of the episode with seed " in said
