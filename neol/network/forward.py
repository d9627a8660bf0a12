"""Networks as arrays, and the forward pass.

The networks of a whole population are packed into one set of arrays, a batch, which compiled code
evaluates without Python. A single network is a batch of one.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import loop_kernel

ACTIVATIONS = {"tanh": 0, "relu": 1, "sigmoid": 2, "identity": 3}
TANH, RELU, SIGMOID, IDENTITY = ACTIVATIONS.values()


class Networks(NamedTuple):
    """P feed-forward networks with M computed nodes and E enabled connections in all.

    A position identifies a node within its network: inputs first, then the hidden nodes in
    topological order, then the outputs. Only hidden and output nodes are computed and stored.
    """

    inputs: int
    outputs: int
    activation: int
    """Activation of hidden nodes, one of `ACTIVATIONS`; outputs use tanh."""
    sum_limit: float
    """A node's summed input is clipped to +-sum_limit before its activation."""
    activation_scale: float
    """Factor of the clipped sum: an output is tanh(activation_scale * sum)."""
    node_offset: npt.NDArray[np.int64]
    """int64[P + 1]: network p computes the nodes node_offset[p] to node_offset[p + 1]."""
    bias: npt.NDArray[np.float64]
    """float64[M]."""
    edge_offset: npt.NDArray[np.int64]
    """int64[M + 1]: node m's incoming connections are edge_offset[m] to edge_offset[m + 1]."""
    source: npt.NDArray[np.int64]
    """int64[E]: position of the presynaptic node in its own network."""
    weight: npt.NDArray[np.float64]
    """float64[E]."""

    @property
    def population(self) -> int:
        """Number of networks P."""
        return len(self.node_offset) - 1

    def slice(self, begin: int, end: int) -> "Networks":
        """Return networks[begin:end] as a batch."""
        first, last = self.node_offset[begin], self.node_offset[end]
        edges = slice(self.edge_offset[first], self.edge_offset[last])
        return self._replace(
            node_offset=self.node_offset[begin : end + 1] - first,
            bias=self.bias[first:last],
            edge_offset=self.edge_offset[first : last + 1] - self.edge_offset[first],
            source=self.source[edges],
            weight=self.weight[edges],
        )

    @property
    def edge_bounds(self) -> npt.NDArray[np.int64]:
        """int64[P + 1]: network p's connections are edge_bounds[p] to edge_bounds[p + 1]."""
        bounds: npt.NDArray[np.int64] = self.edge_offset[self.node_offset]
        return bounds


@loop_kernel
def activate(total: float, activation: int) -> float:
    """Return a node's activity, given its clipped and scaled sum."""
    if activation == TANH:
        return math.tanh(total)
    if activation == RELU:
        return max(total, 0.0)
    if activation == SIGMOID:
        return 1.0 / (1.0 + math.exp(-total))
    return total


@loop_kernel
def forward(networks: Networks, index: int, values: npt.NDArray[np.float64]) -> None:
    """Compute the activities of one network of a batch in place.

    `values` is float64. Its first entries hold the observation, one for each input; the
    activities of the network's nodes are written after them, the outputs last (Section 4.1).
    Unsigned indices spare the inner loop numba's test for negative indices.
    """
    edge_offset, source, weight = networks.edge_offset, networks.source, networks.weight
    limit, scale = networks.sum_limit, networks.activation_scale
    first, last = networks.node_offset[index], networks.node_offset[index + 1]
    for node in range(first, last):
        total = networks.bias[node]
        for edge in range(np.uint64(edge_offset[node]), np.uint64(edge_offset[node + 1])):
            total += weight[edge] * values[np.uint64(source[edge])]
        total = scale * min(max(total, -limit), limit)
        is_output = node >= last - networks.outputs
        values[networks.inputs + node - first] = activate(
            total, TANH if is_output else networks.activation
        )
