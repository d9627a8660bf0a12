"""The table of runs, outcomes by hand, and the cell that represents a method."""

from pathlib import Path

import numpy as np
import pytest

from neol.study.campaign.grid import Cell
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.outcomes import EQUAL, Outcomes, gather
from neol.study.tables.summary import best_fitness
from tests.helpers.made_up import configuration, write_campaign

OJA = Cell("cartpole", "oja", 12, 0.25)
NEAT = Cell("cartpole", "neat", 6, None)


def collected(folder: Path, values: dict[Cell, list[float | None]]) -> Outcomes:
    constants = configuration(generations=3)
    write_campaign(folder, constants, values)
    return gather(Campaign(constants, folder))


def test_the_outcomes_of_a_run_by_hand(tmp_path: Path) -> None:
    """Seed 2 of Oja has 11, 10, 9; M = 1e8 x 3 x 12 / 150,000 = 24,000.

    Compared with NEAT's P = 6, all have a value from 12 evaluations to 18: there the first 11.
    """
    outcomes = collected(tmp_path, {OJA: [2.0, 4.0, 9.0]})
    assert outcomes.values(OJA, "final_best").tolist() == [2, 4, 9]
    assert outcomes.values(OJA, "score")[2] == pytest.approx(12 / 24_000 * (11 + 10 + 9))
    assert outcomes.values(OJA, "held_out").tolist() == [1, 3, 8]
    for metric in EQUAL:
        ours, neats = outcomes.samples([OJA, NEAT], metric)
        assert (ours.tolist(), neats.tolist()) == ([4, 6, 11], [2, 2, 2])


def test_outcomes_are_joined_by_seed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The order in which each outcome lists the seeds changes nothing."""
    values = Campaign.values

    def reversed_values(self: Campaign, cell: Cell, metric: str) -> dict[int, float]:
        found = values(self, cell, metric)
        return found if metric == "final_best" else dict(reversed(found.items()))

    monkeypatch.setattr(Campaign, "values", reversed_values)
    outcomes = collected(tmp_path, {OJA: [2.0, 4.0, 9.0]})
    assert outcomes.values(OJA, "final_best").tolist() == [2, 4, 9]
    assert outcomes.values(OJA, "held_out").tolist() == [1, 3, 8]
    assert outcomes.samples([OJA], "equal_steps")[0].tolist() == [4, 6, 11]


def test_every_run_has_a_row(tmp_path: Path) -> None:
    outcomes = collected(tmp_path, {})
    assert len(outcomes.runs) == len(outcomes.cells) * 3
    assert not outcomes.runs[["final_best", "score", "held_out"]].isna().any(axis=None)
    assert outcomes.values(NEAT, "final_best").tolist() == [0.0] * 3


def test_the_range_is_that_of_the_cells_compared(tmp_path: Path) -> None:
    """Cells of one population share their whole runs, independent of the rest of the grid."""
    outcomes = collected(tmp_path, {})
    large = Cell("cartpole", "neat", 12, None)
    assert outcomes.equal_range([OJA, NEAT], "equal_evaluations") == (12, 18)
    assert outcomes.equal_range([OJA, large], "equal_evaluations") == (12, 36)
    assert outcomes.equal_range([NEAT], "equal_steps") == (60, 180)
    assert np.isnan(outcomes.equal_range([], "equal_steps")).all()


def test_a_mean_at_equal_cost_by_plain_summation(tmp_path: Path) -> None:
    """Averages the best so far after every single evaluation of the range: a second way."""
    outcomes = collected(tmp_path, {OJA: [2.0, 4.0, 9.0]})
    small = Cell("cartpole", "oja", 6, 0.25)
    for compared in ([OJA, NEAT], [OJA, small], [OJA]):
        first, last = (int(end) for end in outcomes.equal_range(compared, "equal_evaluations"))
        for cell, values in zip(
            compared, outcomes.samples(compared, "equal_evaluations"), strict=True
        ):
            for seed, value in enumerate(values):
                runs = outcomes.histories[cell]
                run = runs[runs["seed"] == seed]
                heights = [
                    run.loc[run["evaluations"] <= spent, "best_fitness"].max()
                    for spent in range(first, last)
                ]
                assert value == pytest.approx(np.mean(heights))


def test_missing_seeds_are_counted_and_such_a_cell_is_not_chosen(tmp_path: Path) -> None:
    outcomes = collected(tmp_path, {OJA: [9.0, None, 9.0], NEAT: [None, None, None]})
    assert (outcomes.missing(OJA), outcomes.missing(NEAT)) == (1, 3)
    assert outcomes.chosen("table3", "cartpole", "oja") != OJA
    assert outcomes.values(NEAT, "score").tolist() == []


def test_the_chosen_cell_is_the_best_of_its_setting(tmp_path: Path) -> None:
    small = Cell("cartpole", "oja", 6, 0.0025)
    outcomes = collected(tmp_path, {OJA: [5.0] * 3, small: [6.0] * 3})
    assert outcomes.chosen("table3", "cartpole", "oja") == small
    assert outcomes.chosen("score", "cartpole", "oja") == OJA  # of the largest population
    assert outcomes.chosen("table3", "cartpole", "neat_wo") is None
    assert outcomes.chosen("table4", "cartpole", "neat_wo") is not None


def test_tables_and_effects_choose_the_same_cell(tmp_path: Path) -> None:
    """Two means are equal, though rounded sums would put one higher: the smaller rate wins."""
    constants = configuration(seeds=4)
    low, high = (Cell("cartpole", "oja", 6, rate) for rate in (0.0025, 0.25))
    values = {low: [1e16, 1.0, -1e16, 1.0], high: [1.0, 1.0, 0.0, 0.0]}
    write_campaign(tmp_path, constants, values)
    campaign = Campaign(constants, tmp_path)
    (shown,) = (each.here for each in best_fitness(campaign) if each.method == "oja")
    chosen = gather(campaign).chosen("table3", "cartpole", "oja")
    assert chosen == low == Cell("cartpole", "oja", shown.population, shown.learning_rate)
