"""Historical markings: innovation numbers and node ids (Section A.3 of the paper)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel


class Innovations(NamedTuple):
    """The same structural mutation in one generation gets the same numbers.

    A number is the generation's first one plus the mutation's place in a list of those that have
    happened. Numbers only ever grow, so that they never collide, also after a checkpoint.
    """

    first_innovation: int
    first_node: int
    connections: npt.NDArray[np.int64]
    """int64[n, 2]: source and target of each new connection, rows of -1 after the last one."""
    splits: npt.NDArray[np.int64]
    """int64[n]: innovation number of each connection that was split, -1 after the last one."""

    @classmethod
    def begin(cls, innovation: int, node: int, children: int = 0) -> "Innovations":
        """No mutation yet, with room for so many children: each splits once, connects thrice."""
        return cls(innovation, node, np.full((3 * children, 2), -1), np.full(children, -1))

    @property
    def next_innovation(self) -> int:
        """The lowest innovation number that nothing has."""
        return self.first_innovation + int(np.count_nonzero(self.connections[:, 0] >= 0))

    @property
    def next_node(self) -> int:
        """The lowest node id that nothing has."""
        return self.first_node + int(np.count_nonzero(self.splits >= 0))

    def next_generation(self, children: int) -> "Innovations":
        """Forget which mutations have happened; the numbers go on."""
        return Innovations.begin(self.next_innovation, self.next_node, children)


@kernel
def connection_number(innovations: Innovations, source: int, target: int) -> int:
    """The innovation number of a new connection in this generation."""
    seen = innovations.connections
    for place in range(len(seen)):
        if seen[place, 0] < 0:
            seen[place, 0], seen[place, 1] = source, target
        if seen[place, 0] == source and seen[place, 1] == target:
            return innovations.first_innovation + place
    raise IndexError("more new connections than there is room for")


@kernel
def split_node(innovations: Innovations, innovation: int) -> int:
    """The id of the new node that splits a connection in this generation."""
    for place in range(len(innovations.splits)):
        if innovations.splits[place] < 0:
            innovations.splits[place] = innovation
        if innovations.splits[place] == innovation:
            return innovations.first_node + place
    raise IndexError("more new nodes than there is room for")
