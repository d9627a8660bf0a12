"""Online plasticity: how weights learn after every step of an episode (paper A.3, Algorithm 2).

The reward r gates a rule: gate = gain * r with gain = eta * beta. The loop over a network's
connections is compiled once for each rule and called by address, so the other kernels do not
depend on the rule.
"""

import math
from functools import cache
from typing import Any, NamedTuple

import numba
import numpy as np
import numpy.typing as npt
from numba import types
from numba.extending import register_jitable

from neol.base.c_calls import call_int, plain_address
from neol.base.errors import UserError
from neol.base.kernel import PLAIN, c_function, loop_kernel
from neol.network.forward import Networks
from neol.network.rules import NO_RULE, Rule, find_rule

_INTEGERS: Any = types.CPointer(types.int64)  # type: ignore[no-untyped-call]
_FLOATS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_SIGNATURE = types.int32(
    *(types.int64, types.int64),  # first, last
    *(_INTEGERS, _INTEGERS, _FLOATS, _FLOATS),  # edge_offset, source, weight, threshold
    *(types.int64, types.float64, types.float64, types.float64),  # inputs, gate, alpha, limit
    _FLOATS,  # values
)
"""C signature of a compiled loop; `learn` passes these arguments."""


class Learning(NamedTuple):
    """Learning of a batch of networks; the constants are those of a run's specification."""

    rule: int
    """Address of a rule's compiled loop (see `compiled`)."""
    gain: float
    """eta * beta, the learning rate times the reward scale; times the reward it is the gate."""
    threshold_rate: float
    """Rate alpha of the sliding threshold."""
    weight_limit: float
    threshold: npt.NDArray[np.float64]
    """float64[M]: threshold of each node; changes as the networks learn."""


@loop_kernel
def learn(
    networks: Networks,
    index: int,
    learning: Learning,
    reward: float,
    values: npt.NDArray[np.float64],
) -> bool:
    """Update one network's weights after one step, in place (Algorithm 2, line 11).

    `values` holds the activities of the forward pass that chose the action. Returns whether all
    weights are finite.
    """
    if learning.rule == 0:
        return True
    finite: int = call_int(
        learning.rule,
        networks.node_offset[index],
        networks.node_offset[index + 1],
        networks.edge_offset,
        networks.source,
        networks.weight,
        learning.threshold,
        networks.inputs,
        learning.gain * reward,
        learning.threshold_rate,
        learning.weight_limit,
        values,
    )
    return finite != 0


def compiled(rule: str) -> int:
    """Return the address of a rule's compiled loop, 0 for no rule.

    Raises UserError for an unknown rule.
    """
    if rule == NO_RULE:
        return 0
    loop = learner(find_rule(rule))
    return plain_address(loop) if PLAIN else int(loop.address)


@cache
def learner(rule: Rule) -> Any:
    """Return a rule's loop over connections as a C function; its plain twin if called from Python.

    Weights are clipped to +-weight_limit; each node's threshold then moves by
    theta += alpha * (y^2 - theta). Raises UserError where the rule cannot be compiled.
    """
    change = register_jitable(error_model="numpy")(rule.change)

    def loop(first, last, offset, source, weight, threshold, inputs, gate, alpha, limit, values):  # type: ignore[no-untyped-def]
        finite = True
        for node in range(first, last):
            y = values[inputs + node - first]
            theta = threshold[node]
            for edge in range(offset[node], offset[node + 1]):
                w = weight[edge]
                w += gate * change(values[source[edge]], y, w, theta)
                finite &= math.isfinite(w)
                weight[edge] = min(max(w, -limit), limit)
            threshold[node] = theta + alpha * (y * y - theta)
        return finite

    if PLAIN:
        return loop
    loop.__qualname__ = f"learn_{rule.name}"  # distinguishes loops in the cache and the linker
    # A rule from another module is compiled in each process: the cache cannot see its edits.
    cached = rule.change.__module__.startswith("neol.")
    try:
        return c_function(loop, _SIGNATURE, cached)
    except numba.core.errors.NumbaError as error:
        check = f"numba.njit({rule.name})(1.0, 1.0, 1.0, 1.0)"
        raise UserError(f"rule {rule.name}: numba cannot compile it; {check} says why") from error
