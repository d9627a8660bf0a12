"""Our NEAT beside neat-python 0.92: the comparison's verdicts, and what it was made of."""

import importlib.metadata
import importlib.util
import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from benchmarks import agreement, library
from benchmarks.agreement import COLUMNS, COMPARISONS, LIBRARY, OURS, judge, our_generations
from neol.neat.decoding import decode
from neol.neat.genome import Pool, check_genome
from neol.network.forward import forward
from neol.rollout import make_engine
from neol.spec.configuration import ROOT, load_configuration
from tests.run.test_digests import SAME_LAST_BITS

PAGE = ROOT / "docs" / "neat-python.md"


def rows_of(comparison: str) -> pd.DataFrame:
    """The shipped runs of a comparison."""
    runs = agreement.read()
    return runs[runs["comparison"] == comparison]


@pytest.mark.parametrize("comparison", COMPARISONS)
def test_the_page_has_the_table_of_the_shipped_runs(comparison: str) -> None:
    assert agreement.table(judge(rows_of(comparison))) in PAGE.read_text(encoding="utf-8")


def test_shipped_runs_are_those_that_were_declared() -> None:
    for name, (_, first_seeds, counts) in COMPARISONS.items():
        runs = rows_of(name)
        for side, first in first_seeds.items():
            for task, count in counts.items():
                here = runs[(runs["evolves"] == side) & (runs["task"] == task)]
                assert sorted(set(here["seed"])) == list(range(first, first + count))
                assert len(here) == 4 * count


def test_a_difference_beyond_the_margin_is_not_equivalent() -> None:
    runs = rows_of("second")
    column, margin = "mean_fitness", agreement.FITNESS_MARGIN["cartpole"]
    before = {each[:3]: each.equivalent for each in judge(runs)}
    ours = (runs["evolves"] == OURS) & (runs["task"] == "cartpole")
    moved = runs.assign(**{column: runs[column] + margin * ours})
    after = {each[:3]: each.equivalent for each in judge(moved)}
    changed = {place for place, equivalent in before.items() if equivalent != after[place]}
    assert changed == {("cartpole", column, "all"), ("cartpole", column, "last 10")}


@pytest.mark.skipif(not SAME_LAST_BITS, reason="the last bits of tanh differ here")
def test_our_side_can_be_made_again() -> None:
    spec = agreement.run_spec(COMPARISONS["second"].reading, "cartpole", 1_007_000)
    engine = make_engine(spec.task)
    check_first_run(OURS, np.array(list(our_generations(spec, engine))))
    engine.close()


@pytest.mark.slow
@pytest.mark.skipif(
    not SAME_LAST_BITS or importlib.util.find_spec("neat") is None,
    reason="neat-python 0.92 is installed on demand: make agreement",
)
def test_the_librarys_side_can_be_made_again() -> None:
    if importlib.metadata.version("neat-python") != "0.92":
        pytest.skip("another release of neat-python is installed")
    spec = agreement.run_spec(COMPARISONS["second"].reading, "cartpole", 1_008_000)
    engine = make_engine(spec.task)
    check_first_run(LIBRARY, np.array(list(library.evolve(spec, engine))))
    engine.close()


def check_first_run(side: str, values: np.ndarray) -> None:  # type: ignore[type-arg]
    """Compare a run's generations with the shipped means of the side's first run."""
    runs = rows_of("second")
    first = COMPARISONS["second"].first_seeds[side]
    shipped = runs[(runs["evolves"] == side) & (runs["seed"] == first)]
    shipped = shipped[shipped["task"] == "cartpole"]
    means = values.reshape(-1, agreement.STRETCH, len(COLUMNS)).mean(axis=1)
    np.testing.assert_allclose(means, shipped[list(COLUMNS)].to_numpy(), rtol=1e-5)


def test_a_translated_genome_computes_what_the_librarys_would() -> None:
    """Two inputs, two outputs; output 0 feeds hidden node 2, which feeds output 1."""
    biases = {0: 0.1, 1: -0.2, 2: 0.3}
    links = {(-1, 0): 0.5, (-2, 0): -1.0, (-1, 2): 2.0, (0, 2): 1.5, (2, 1): -0.7, (-2, 1): 9.0}
    genome = SimpleNamespace(
        nodes={key: SimpleNamespace(bias=bias) for key, bias in biases.items()},
        connections={
            key: SimpleNamespace(weight=weight, enabled=weight != 9.0)
            for key, weight in links.items()
        },
    )
    translated = library.translate(genome, inputs=2, outputs=2)
    check_genome(translated, inputs=2, outputs=2)
    network = load_configuration(reading="neat_python").network
    networks, _ = decode(Pool.of([translated]), 2, 2, network)
    values = np.zeros(2 + len(networks.bias))
    values[:2] = x, y = 0.4, -0.6
    forward(networks, 0, values)
    first = math.tanh(2.5 * (0.1 + 0.5 * x - 1.0 * y))
    hidden = math.tanh(2.5 * (0.3 + 2.0 * x + 1.5 * first))
    second = math.tanh(2.5 * (-0.2 - 0.7 * hidden))
    assert values[-2:] == pytest.approx([first, second])
