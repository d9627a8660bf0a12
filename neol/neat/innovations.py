"""Historical markings: innovation numbers and node ids (Section A.3 of the paper)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel
from neol.neat.genome import MAX_NODE_ID


class Innovations(NamedTuple):
    """Numbers of a generation's structural mutations: equal mutations get equal numbers.

    A number is the generation's first one plus the mutation's place in the list of those so far.
    Numbers only grow, so they never collide, also after a checkpoint.

    Where connections are known `by_endpoints`, source and target make the number, and every split
    gets a node of its own.
    """

    by_endpoints: bool
    first_innovation: int
    first_node: int
    connections: npt.NDArray[np.int64]
    """int64[n, 2]: source and target of each new connection, rows of -1 after the last one."""
    splits: npt.NDArray[np.int64]
    """int64[n]: innovation number of each connection that was split, -1 after the last one."""

    @classmethod
    def begin(
        cls, innovation: int, node: int, children: int = 0, *, by_endpoints: bool = False
    ) -> "Innovations":
        """Start without mutations, with room for one split and three connections a child."""
        connections, splits = np.full((3 * children, 2), -1), np.full(children, -1)
        return cls(by_endpoints, innovation, node, connections, splits)

    @property
    def next_innovation(self) -> int:
        """Lowest free innovation number."""
        return self.first_innovation + int(np.count_nonzero(self.connections[:, 0] >= 0))

    @property
    def next_node(self) -> int:
        """Lowest free node id."""
        return self.first_node + int(np.count_nonzero(self.splits >= 0))

    def next_generation(self, children: int) -> "Innovations":
        """Clear the list of mutations; the numbers continue."""
        return Innovations.begin(
            self.next_innovation, self.next_node, children, by_endpoints=self.by_endpoints
        )


@kernel
def connection_number(innovations: Innovations, source: int, target: int) -> int:
    """Return the innovation number of a new connection in this generation."""
    if innovations.by_endpoints:
        return target * MAX_NODE_ID + source
    seen = innovations.connections
    for place in range(len(seen)):
        if seen[place, 0] < 0:
            seen[place, 0], seen[place, 1] = source, target
        if seen[place, 0] == source and seen[place, 1] == target:
            return innovations.first_innovation + place
    raise IndexError("more new connections than there is room for")


@kernel
def split_node(innovations: Innovations, innovation: int) -> int:
    """Return the id of the new node that splits a connection in this generation."""
    for place in range(len(innovations.splits)):
        free = innovations.splits[place] < 0
        if free:
            innovations.splits[place] = innovation
        if free or (innovations.splits[place] == innovation and not innovations.by_endpoints):
            return innovations.first_node + place
    raise IndexError("more new nodes than there is room for")
