"""The rules: by hand over several steps, and the kernel against a plain twin."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neol.network.plasticity import compiled, learn, learner
from neol.network.rules import NO_RULE, find_rule

ONE_EDGE = {
    "first": 0,
    "last": 1,
    "edge_offset": np.array([0, 1]),
    "source": np.array([0]),
    "inputs": 1,
}


def learn_steps(
    rule: str, steps: list[tuple[float, float, float]], w: float, alpha: float = 0.5
) -> tuple[float, float]:
    """Weight and threshold of one connection after steps of (x, y, gate)."""
    weight, threshold = np.array([w]), np.zeros(1)
    for x, y, gate in steps:
        learn(
            **ONE_EDGE,
            weight=weight,
            threshold=threshold,
            rule=compiled(rule),
            gate=gate,
            threshold_rate=alpha,
            weight_limit=10.0,
            values=np.array([x, y]),
        )
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
    finite = learn(
        **ONE_EDGE,
        weight=np.zeros(1),
        threshold=np.zeros(1),
        rule=compiled(rule),
        gate=math.inf,
        threshold_rate=0.1,
        weight_limit=10.0,
        values=np.array([1.0, 0.0]),
    )
    assert not finite


def test_oja_settles_where_its_weight_has_norm_one() -> None:
    """Oja (1982): with y = w x and constant x, w tends to the unit vector along x."""
    weight, x = np.array([0.1, 0.2]), np.array([0.6, 0.8])
    for _ in range(2000):
        values = np.array([*x, weight @ x])
        learn(
            0, 1, np.array([0, 2]), np.array([0, 1]), weight, np.zeros(1), 2,
            compiled("oja"), 0.05, 0.1, 10.0, values,
        )  # fmt: skip
    assert np.linalg.norm(weight) == pytest.approx(1.0)


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
    rest = {"gate": gate, "threshold_rate": 0.1, "weight_limit": 10.0, "values": np.array([x, y])}
    learn(**ONE_EDGE, weight=weights[0], threshold=thresholds[0], rule=compiled(rule), **rest)
    if rule != NO_RULE:
        edge = ONE_EDGE["edge_offset"], ONE_EDGE["source"], weights[1], thresholds[1]
        learner(find_rule(rule))(0, 1, *edge, 1, *rest.values())
    expected = plain(rule, x, y, w, gate, theta)
    assert [*zip(weights[:, 0], thresholds[:, 0], strict=True)] == [expected, expected]


def plain(
    rule: str, x: float, y: float, w: float, gate: float, theta: float
) -> tuple[float, float]:
    """The specification, word for word."""
    if rule == "none":
        return w, theta
    change = {"hebb": x * y, "oja": y * (x - y * w), "bcm": y * (y - theta) * x}[rule]
    return min(max(w + gate * change, -10.0), 10.0), theta + 0.1 * (y * y - theta)
