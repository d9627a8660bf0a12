"""Statistics by hand, choices and ties, degenerate input."""

import math
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import Cell
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import best, candidates
from neol.study.tables.summary import best_fitness, mean_sd, ranks
from tests.helpers.made_up import configuration, write_campaign

OJA = [Cell("cartpole", "oja", p, rate) for p in (6, 12) for rate in (0.0025, 0.25)]


def summaries(results: Path, final_best: dict[Cell, list[float | None]], **settings: int) -> dict:
    constants = configuration(**settings)
    write_campaign(results, constants, final_best)
    return {each.method: each.here for each in best_fitness(Campaign(constants, results))}


def test_mean_and_deviation_by_hand() -> None:
    assert mean_sd([2.0, 4.0, 9.0]) == (5.0, pytest.approx(math.sqrt(13.0)))  # (9 + 1 + 16) / 2
    assert mean_sd([7.0, 7.0]) == (7.0, 0.0)


def test_one_value_has_no_deviation_and_none_no_mean() -> None:
    mean, sd = mean_sd([3.0])
    assert mean == 3.0
    assert math.isnan(sd)
    assert all(math.isnan(value) for value in mean_sd([]))


def test_the_order_of_values_is_nothing_to_the_mean() -> None:
    values = [0.1, 1e16, -1e16, 0.2, 0.3]
    assert mean_sd(values) == mean_sd(sorted(values))


@pytest.mark.parametrize(
    ("means", "expected"),
    [
        ([1.0, 3.0, 2.0, 0.0], ["", "best", "runner-up", ""]),
        ([1.0, 3.0, 1.0, 0.0], ["runner-up", "best", "runner-up", ""]),
        ([5.0, 5.0, 4.0, 3.0], ["best", "best", "", ""]),
        ([5.0, 5.0, 5.0, 5.0], ["best"] * 4),
        ([math.nan, 2.0, math.nan, 1.0], ["", "best", "", "runner-up"]),
        ([math.nan, 2.0], ["", "best"]),
        ([math.nan, math.nan], ["", ""]),
        ([-1.0, -2.0], ["best", "runner-up"]),
        ([1.0, 1.0 + 1e-9], ["runner-up", "best"]),
    ],
)
def test_ranks(means: list[float], expected: list[str]) -> None:
    assert ranks(means) == expected


def test_equal_cells_the_smaller_population_then_the_smaller_rate() -> None:
    assert best(dict.fromkeys(reversed(OJA), 1.0)) == OJA[0]
    assert best({OJA[2]: 1.0, OJA[1]: 1.0}) == OJA[1]
    assert best({OJA[0]: 1.0, OJA[3]: 2.0}) == OJA[3]


def test_the_papers_configuration_stands_where_the_grid_has_it() -> None:
    chosen = candidates(load_configuration("paper"))
    assert chosen["lunar_lander", "oja"] == [Cell("lunar_lander", "oja", 300, 0.0025)]
    assert chosen["bipedal_walker", "neat"] == [Cell("bipedal_walker", "neat", 100, None)]
    assert len(chosen) == 16
    assert all(len(cells) == 1 for cells in chosen.values())


def test_otherwise_the_whole_grid_is_a_candidate() -> None:
    chosen = candidates(configuration())
    assert chosen["cartpole", "oja"] == OJA
    assert ("cartpole", "neat_wo") not in chosen


def test_the_final_generation_of_the_best_cell_counts(tmp_path: Path) -> None:
    oja = summaries(tmp_path, {OJA[2]: [2.0, 4.0, 9.0]})["oja"]
    assert (oja.population, oja.learning_rate) == (12, 0.0025)
    assert (oja.mean, oja.sd, oja.seeds) == (5.0, pytest.approx(math.sqrt(13.0)), 3)
    assert (oja.rank, oja.chosen, oja.incomplete) == ("best", "grid", "")


def test_one_seed(tmp_path: Path) -> None:
    oja = summaries(tmp_path, {OJA[2]: [4.0]}, seeds=1)["oja"]
    assert (oja.mean, oja.rank) == (4.0, "best")
    assert math.isnan(oja.sd)


def test_all_equal(tmp_path: Path) -> None:
    here = summaries(tmp_path, {})
    assert {each.rank for each in here.values()} == {"best"}
    assert {(each.mean, each.sd) for each in here.values()} == {(0.0, 0.0)}
    assert {each.population for each in here.values()} == {6}


def test_a_cell_that_lacks_a_seed_is_not_chosen_and_the_choice_is_marked(tmp_path: Path) -> None:
    oja = summaries(tmp_path, {OJA[2]: [9.0, None, 9.0], OJA[1]: [1.0, 1.0, 1.0]})["oja"]
    assert (oja.population, oja.mean, oja.rank) == (6, 1.0, "")
    assert oja.incomplete == "chosen among the 3 of 4 cells that are complete"


def test_no_complete_cell_no_value(tmp_path: Path) -> None:
    oja = summaries(tmp_path, {cell: [1.0, None, 1.0] for cell in OJA})["oja"]
    assert math.isnan(oja.mean)
    assert oja.incomplete == "none of 4 cells is complete"


def test_a_single_cell_that_lacks_seeds_is_marked_and_not_ranked(tmp_path: Path) -> None:
    constants = configuration().model_copy(
        update={"budget": configuration().budget.model_copy(update={"populations": (50,)})}
    )
    cell = Cell("cartpole", "neat", 50, None)
    write_campaign(tmp_path, constants, {cell: [8.0, None, 4.0]})
    here = {each.method: each.here for each in best_fitness(Campaign(constants, tmp_path))}
    neat = here["neat"]
    assert (neat.chosen, neat.mean, neat.seeds, neat.rank) == ("Table 3", 6.0, 2, "")
    assert neat.incomplete == "without seeds 1"


def test_the_papers_own_values(tmp_path: Path) -> None:
    constants = configuration(tasks=("hopper",))
    write_campaign(tmp_path, constants, {})
    paper = {each.method: each.paper for each in best_fitness(Campaign(constants, tmp_path))}
    assert (paper["bcm"].mean, paper["bcm"].sd, paper["bcm"].rank) == (2983.82, 479.79, "best")
    assert (paper["oja"].population, paper["oja"].learning_rate) == (300, 0.0025)
    assert (paper["oja"].rank, paper["hebb"].rank) == ("runner-up", "")


def test_a_task_that_the_paper_does_not_have(tmp_path: Path) -> None:
    constants = configuration(tasks=("bipedal_walker_hardcore",))
    write_campaign(tmp_path, constants, {})
    assert all(math.isnan(each.paper.mean) for each in best_fitness(Campaign(constants, tmp_path)))


def test_records_of_another_specification_are_refused(tmp_path: Path) -> None:
    write_campaign(tmp_path, configuration(generations=3), {})
    with pytest.raises(UserError, match="generations is 3 there and 2 here"):
        best_fitness(Campaign(configuration(generations=2), tmp_path))


def test_seeds_beyond_the_files_name_are_refused(tmp_path: Path) -> None:
    write_campaign(tmp_path, configuration(seeds=3), {})
    for path in tmp_path.rglob("*.parquet"):
        path.rename(path.with_name("seeds_000-001.parquet"))
    with pytest.raises(UserError, match="holds seed 2, its name says 0 to 1"):
        best_fitness(Campaign(configuration(seeds=2), tmp_path))
