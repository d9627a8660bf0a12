"""Online plasticity: how weights learn after every step of an episode (paper A.3, Algorithm 2).

Every rule is local: presynaptic activity x, postsynaptic activity y, weight w, threshold theta.
The reward opens its gate: gate = eta * beta * r.
"""

import math

import numpy as np
import numpy.typing as npt

from neol.kernel import kernel

RULES = {"none": 0, "hebb": 1, "oja": 2, "bcm": 3}
NONE, HEBB, OJA, BCM = RULES.values()


@kernel
def hebb(x: float, y: float) -> float:
    """Hebb's rule (Equation 1)."""
    return x * y


@kernel
def oja(x: float, y: float, w: float) -> float:
    """Oja's rule: Hebb's with a decay that bounds the weights (Equation 2)."""
    return y * (x - y * w)


@kernel
def bcm(x: float, y: float, theta: float) -> float:
    """The BCM rule: depression below the threshold theta, potentiation above (Equation 3)."""
    return y * (y - theta) * x


@kernel
def learn(
    first: int,
    last: int,
    edge_offset: npt.NDArray[np.int64],
    source: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
    threshold: npt.NDArray[np.float64],
    inputs: int,
    rule: int,
    gate: float,
    threshold_rate: float,
    weight_limit: float,
    values: npt.NDArray[np.float64],
) -> bool:
    """Let the nodes first..last of a batch learn from one step, in place (Algorithm 2, line 11).

    The network's arrays are those of `neol.network.Networks`; `values` holds the activities of
    the forward pass that chose the action; `gate` is eta * beta * r. Weights are clipped to
    +-weight_limit; BCM's thresholds (one a node) then move by theta += alpha * (y^2 - theta).
    Returns whether all weights stayed finite. (Unsigned indices as in `neol.network.forward`.)
    """
    if rule == NONE:
        return True
    finite = True
    for node in range(first, last):
        y = values[inputs + node - first]
        theta = threshold[node]
        for edge in range(np.uint64(edge_offset[node]), np.uint64(edge_offset[node + 1])):
            x = values[np.uint64(source[edge])]
            w = weight[edge]
            if rule == HEBB:
                w += gate * hebb(x, y)
            elif rule == OJA:
                w += gate * oja(x, y, w)
            else:
                w += gate * bcm(x, y, theta)
            finite &= math.isfinite(w)
            weight[edge] = min(max(w, -weight_limit), weight_limit)
        if rule == BCM:
            threshold[node] = theta + threshold_rate * (y * y - theta)
    return finite
