"""Genomes from files: only well-formed ones pass."""

from collections.abc import Callable

import numpy as np
import pytest

from neol.neat.genome import CONNECTION, NODE, Genome, check_genome


def genome() -> Genome:
    """Two inputs (0, 1), one output (2), two hidden nodes in a row (3, 4)."""
    connections = [
        (0, 0, 2, 0.5, True),
        (1, 1, 2, 0.5, False),
        (2, 1, 3, 1.0, True),
        (3, 3, 4, 0.5, True),
        (4, 4, 2, 0.5, False),
    ]
    return Genome(
        7,
        np.array([(2, 0.0), (3, 0.1), (4, 0.2)], dtype=NODE),
        np.array(connections, dtype=CONNECTION),
    )


def test_a_well_formed_genome_passes() -> None:
    check_genome(genome(), 2, 1)


def put(column: str, place: int, value: float) -> Callable[[Genome], None]:
    def change(broken: Genome) -> None:
        genes = broken.nodes if column in NODE.names else broken.connections  # type: ignore[operator]
        genes[column][place] = value

    return change


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (put("id", 2, 3), "nodes are not in order"),
        (put("id", 0, 1), "output nodes are missing"),
        (put("id", 2, 2**40), "a node id is too large"),
        (put("innovation", 4, 3), "connections are not in order"),
        (put("innovation", 0, -1), "connections are not in order"),
        (put("source", 0, 5), "comes from nowhere"),
        (put("source", 0, 2), "comes from nowhere"),
        (put("source", 0, -1), "comes from nowhere"),
        (put("target", 0, 0), "leads nowhere"),
        (put("weight", 0, np.nan), "not finite"),
        (put("bias", 0, np.inf), "not finite"),
        (put("target", 4, 3), "cycle"),
        (put("target", 3, 3), "cycle"),
    ],
)
def test_a_broken_genome_is_refused(change: Callable[[Genome], None], reason: str) -> None:
    broken = genome()
    change(broken)
    with pytest.raises(ValueError, match=f"genome 7: .*{reason}"):
        check_genome(broken, 2, 1)
