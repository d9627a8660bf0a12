"""The genomes of one generation, with their genes in one pool."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from neol.neat.genome import Genome, Pool


@dataclass(frozen=True, slots=True)
class Population:
    """P genomes with consecutive ids: the genome in the lower place is the older one."""

    first_id: int
    pool: Pool
    fitness: npt.NDArray[np.float64]
    """float64[P]: mean return of each genome's evaluation; NaN before it."""

    @classmethod
    def of(cls, genomes: Sequence[Genome]) -> "Population":
        """Copy genomes into a population. Raises ValueError unless their ids are consecutive."""
        first = genomes[0].id if genomes else 0
        if [genome.id for genome in genomes] != list(range(first, first + len(genomes))):
            raise ValueError("the ids of a population's genomes are not consecutive")
        return cls(first, Pool.of(genomes), np.array([genome.fitness for genome in genomes]))

    def __len__(self) -> int:
        return len(self.fitness)

    def __getitem__(self, place: int) -> Genome:
        """Return the genome in a place; its arrays are views of the pool."""
        node, connection = self.pool.node_offset, self.pool.connection_offset
        return Genome(
            self.first_id + place,
            self.pool.nodes[node[place] : node[place + 1]],
            self.pool.connections[connection[place] : connection[place + 1]],
            float(self.fitness[place]),
        )

    def __iter__(self) -> Iterator[Genome]:
        return (self[place] for place in range(len(self)))
