"""Content of a record: exact champions, the spread of episodes, runs of one cell."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neol.neat.genome import CONNECTION, NODE, Genome
from neol.run.record import Champion, HeldOut, join
from neol.run.runner import evolve
from tests.helpers.runs import run_spec

floats = st.floats(allow_nan=False, allow_infinity=False)


@given(
    weights=st.lists(floats, min_size=1, max_size=20),
    biases=st.lists(floats, min_size=1, max_size=5),
    fitness=floats,
)
def test_champions_floats_are_exact(
    weights: list[float], biases: list[float], fitness: float
) -> None:
    genome = Genome(
        3,
        np.array(list(enumerate(biases)), dtype=NODE),
        np.array([(i, 0, 1, w, i % 2 == 0) for i, w in enumerate(weights)], dtype=CONNECTION),
        fitness,
    )
    text = Champion.of(genome).model_dump_json()
    read = Champion.model_validate_json(text).genome()
    assert read.nodes["bias"].tobytes() == genome.nodes["bias"].tobytes()
    assert read.connections["weight"].tobytes() == genome.connections["weight"].tobytes()
    assert read.connections["enabled"].tolist() == genome.connections["enabled"].tolist()
    assert (read.id, read.fitness) == (3, fitness)


def test_held_out_mean_and_spread() -> None:
    held_out = HeldOut.of(np.array([1.0, 2.0, np.nan, 6.0]))
    assert held_out.returns == (1.0, 2.0, None, 6.0)
    assert held_out.mean == 3.0
    assert held_out.sd == pytest.approx(7**0.5)
    assert HeldOut.of(np.array([np.nan])).mean is None
    assert HeldOut.of(np.array([1.0])).sd is None


def test_held_out_returns_whose_sum_overflows_have_a_mean() -> None:
    held_out = HeldOut.of(np.array([1e308, 1.5e308]))
    assert (held_out.mean, held_out.sd) == (1.25e308, pytest.approx(5e307 / 2**0.5))
    assert HeldOut.of(np.array([-1.7e308, 1.7e308])).sd is None, "no float is so large"


def test_runs_of_one_cell_join_by_seed() -> None:
    spec = run_spec(generations=2)
    one, other = (evolve(spec, [seed]) for seed in (4, 0))
    joined = join([one, other])
    assert [info.seed for info in joined.seeds] == [0, 4]
    assert joined.table["seed"].to_pylist() == [0, 0, 4, 4]
    for foreign in ({"spec": run_spec(population=9)}, {"budget": "demo"}, {"reading": "first"}):
        with pytest.raises(AssertionError):
            join([one, dataclasses.replace(other, **foreign)])


def test_a_record_is_shown_in_one_line() -> None:
    spec = run_spec(population=6, generations=1)
    assert (
        repr(evolve(spec, [0, 1])) == "<Record of cartpole, oja, P=6, eta=0.25, G=1, seeds [0, 1]>"
    )
    shown = "<Record of cartpole, neat, P=6, G=1, seeds [0, ..., 4] (5)>"
    assert repr(evolve(run_spec("neat", population=6, generations=1), range(5))) == shown
