"""The rules: by hand over several steps, and the kernel against a plain twin."""

import errno
import math
from pickle import UnpicklingError

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neol.network.plasticity import Learning, compiled, learn, learner
from neol.network.rules import NO_RULE, find_rule
from tests.helpers.networks import one_node


def learning(rule: str, threshold: np.ndarray, alpha: float = 0.1) -> Learning:
    """Return learning with a gain of 1, so that the gate equals the reward."""
    return Learning(compiled(rule), 1.0, alpha, 10.0, threshold)


def learn_steps(
    rule: str, steps: list[tuple[float, float, float]], w: float, alpha: float = 0.5
) -> tuple[float, float]:
    """Return weight and threshold of one connection after steps of (x, y, gate)."""
    weight, threshold = np.array([w]), np.zeros(1)
    for x, y, gate in steps:
        learn(one_node(weight), 0, learning(rule, threshold, alpha), gate, np.array([x, y]))
    return float(weight[0]), float(threshold[0])


STEPS = [(1.0, 0.5, 0.5), (2.0, 0.5, 1.0), (-1.0, 0.5, -2.0)]


# theta, of all rules: 0, then 0.5 * (0.25 - 0) = 0.125, then 0.1875, then 0.21875


def test_hebb_by_hand() -> None:
    # 1 + 0.5 * 1 * 0.5 = 1.25;  + 1 * 2 * 0.5 = 2.25;  - 2 * -1 * 0.5 = 3.25
    assert learn_steps("hebb", STEPS, w=1.0) == (3.25, 0.21875)


def test_oja_by_hand() -> None:
    # 1 + 0.5 * 0.5 * (1 - 0.5) = 1.125;  + 0.5 * (2 - 0.5625) = 1.84375
    # - 2 * 0.5 * (-1 - 0.921875) = 3.765625
    assert learn_steps("oja", STEPS, w=1.0) == (3.765625, 0.21875)


def test_bcm_by_hand() -> None:
    # 1 + 0.5 * 0.5 * 0.5 * 1 = 1.125;  + 0.5 * 0.375 * 2 = 1.5;  - 2 * 0.5 * 0.3125 * -1 = 1.8125
    assert learn_steps("bcm", STEPS, w=1.0) == (1.8125, 0.21875)


def test_no_rule_changes_nothing() -> None:
    assert learn_steps("none", STEPS, w=1.0) == (1.0, 0.0)


@pytest.mark.parametrize("rule", ["hebb", "oja", "bcm"])
def test_weights_are_clipped(rule: str) -> None:
    assert learn_steps(rule, [(1.0, 1.0, 1e6)], w=0.0)[0] == 10.0
    assert learn_steps(rule, [(1.0, 1.0, -1e6)], w=0.0)[0] == -10.0


@pytest.mark.parametrize("rule", ["hebb", "oja", "bcm"])
def test_a_weight_that_is_not_finite_is_reported(rule: str) -> None:
    values = np.array([1.0, 0.0])
    finite = learn(one_node(np.zeros(1)), 0, learning(rule, np.zeros(1)), math.inf, values)
    assert not finite


def test_oja_settles_where_its_weight_has_norm_one() -> None:
    """Oja (1982): with y = w x and constant x, w tends to the unit vector along x."""
    weight, x = np.array([0.1, 0.2]), np.array([0.6, 0.8])
    for _ in range(2000):
        values = np.array([*x, weight @ x])
        learn(one_node(weight), 0, learning("oja", np.zeros(1)), 0.05, values)
    assert np.linalg.norm(weight) == pytest.approx(1.0)


def test_a_rule_is_compiled_where_the_cache_is_damaged_and_full(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def damaged(*_: object) -> None:
        raise UnpicklingError("invalid load key")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile._load_index", damaged)
    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile._save_index", full)
    assert learner.__wrapped__(find_rule("oja")).address


numbers = st.floats(-5, 5)


@given(
    rule=st.sampled_from([NO_RULE, "hebb", "oja", "bcm"]),
    x=numbers,
    y=numbers,
    w=numbers,
    gate=numbers,
    theta=st.floats(0, 5),
)
def test_kernel_equals_its_plain_twin(
    rule: str, x: float, y: float, w: float, gate: float, theta: float
) -> None:
    weights, thresholds = np.array([[w], [w]]), np.array([[theta], [theta]])
    values = np.array([x, y])
    learn(one_node(weights[0]), 0, learning(rule, thresholds[0]), gate, values)
    if rule != NO_RULE:
        edges = np.array([0, 1]), np.array([0]), weights[1], thresholds[1]
        learner(find_rule(rule))(0, 1, *edges, 1, gate, 0.1, 10.0, values)
    expected = plain(rule, x, y, w, gate, theta)
    assert [*zip(weights[:, 0], thresholds[:, 0], strict=True)] == [expected, expected]


def plain(
    rule: str, x: float, y: float, w: float, gate: float, theta: float
) -> tuple[float, float]:
    """Apply the rules exactly as the specification writes them."""
    if rule == "none":
        return w, theta
    change = {"hebb": x * y, "oja": y * (x - y * w), "bcm": y * (y - theta) * x}[rule]
    return min(max(w + gate * change, -10.0), 10.0), theta + 0.1 * (y * y - theta)
