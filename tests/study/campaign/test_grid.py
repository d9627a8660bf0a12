from collections import Counter
from pathlib import Path

import pytest

from neol.spec.configuration import Configuration, load_configuration
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import (
    Cell,
    blocks,
    cells,
    check_shared_records,
    paper_cells,
    run_specs,
)
from neol.study.campaign.jobs import SENSITIVITY, jobs
from tests.helpers.refusal import refusal


@pytest.fixture(scope="module")
def paper() -> Configuration:
    return load_configuration("paper")


def test_the_paper_s_campaign_has_208_cells_and_6240_runs(paper):
    without = [cell for cell in cells(paper) if cell.method != "neat_wo"]
    assert len(without) == 208
    assert len(without) * paper.budget.seeds == 6240
    assert Counter(cell.method for cell in cells(paper)) == {
        "hebb": 64,
        "oja": 64,
        "bcm": 64,
        "neat": 16,
        "neat_wo": 16,
    }


def test_order_is_that_of_the_file(paper):
    assert cells(paper) == cells(paper)
    assert cells(paper)[:2] == [
        Cell("cartpole", "hebb", 50, 2.5e-4),
        Cell("cartpole", "hebb", 50, 2.5e-3),
    ]
    assert cells(paper)[-1] == Cell("bipedal_walker", "neat_wo", 300, None)


def test_a_record_s_path_says_reading_budget_cell_and_seeds(paper):
    records = [block.record for block in blocks(paper)]
    assert len(set(records)) == len(records) == 224 * 6
    hebb = "rare_mutation/paper/cartpole/hebb/p050_lr0.00025/seeds_000-029.parquet"
    assert records[0] == Path(hebb)
    neat = "rare_mutation/paper/bipedal_walker/neat_wo/p300/seeds_027-029.parquet"
    assert records[-1] == Path(neat)


def test_records_of_different_budgets_and_readings_share_no_path():
    paths = [
        block.record
        for name in ("smoke", "desk")
        for reading in ("worked_example", "first", "first+plasticity.reward_scale=0.1")
        for block in blocks(load_configuration(name, reading=reading))
    ]
    assert len(set(paths)) == len(paths)


def test_runs_of_another_budget_have_its_records(paper):
    evidence = load_configuration("evidence")
    check_shared_records(evidence)
    shared = {block for block in blocks(evidence) if block.cell.task in evidence.budget.records_of}
    assert shared == set(blocks(evidence)) & set(blocks(paper))
    places = {(job.spec.task.name, job.budget) for job in jobs(evidence) if job.part != SENSITIVITY}
    assert places == {
        ("cartpole", "paper"),
        ("lunar_lander", "paper"),
        ("hopper", "evidence"),
        ("bipedal_walker", "paper"),
    }


@pytest.mark.parametrize(
    "change",
    ["budget.seeds=5", "budget.generations=60", "budget.methods=[oja_mutated]", "neat.elitism=3"],
)
def test_runs_that_another_budget_does_not_have(change):
    line = refusal(check_shared_records, load_configuration("evidence", [change]))
    assert line.startswith(f"budget evidence: records_of.cartpole = paper: {DEFAULT_READING}/")


def test_one_task_may_have_its_grid_and_another_the_papers_configurations():
    assert Counter(cell.task for cell in cells(load_configuration("evidence"))) == {
        "cartpole": 56,
        "lunar_lander": 14,
        "hopper": 5,
        "bipedal_walker": 5,
    }


def test_a_population_that_a_budget_of_tables_lacks_becomes_its_largest():
    evidence = load_configuration("evidence")
    there = cells(evidence)
    assert len(there) == 56 + 14 + 5 + 5
    assert {cell.population for cell in there if cell.task == "hopper"} == {100}
    for table in (3, 4):
        assert len(paper_cells(evidence, table)) == 16
    walker = paper_cells(load_configuration("evidence", ["budget.populations=[100, 200]"]), 3)
    assert walker["bipedal_walker", "neat"].population == 100  # as in Table 3
    assert walker["bipedal_walker", "bcm"].population == 200  # 300 in Table 3


def test_seeds_may_begin_elsewhere_than_at_0():
    seeds = "budget.seeds={first: 1000, count: 5}"
    configuration = load_configuration("smoke", [seeds, "budget.seeds_per_job=3"])
    first, second, *_ = blocks(configuration)
    assert (first.seeds, second.seeds) == (range(1000, 1003), range(1003, 1005))
    assert first.record.name == "seeds_1000-1002.parquet"
    assert [run.seed for run in run_specs(configuration, second)] == [1003, 1004]


def test_a_tiny_rate_is_written_without_exponent():
    assert Cell("hopper", "oja", 7, 2.5e-7).folder == Path("hopper/oja/p007_lr0.00000025")


@pytest.mark.parametrize(("seeds", "per_job"), [(1, 5), (5, 5), (7, 3)])
def test_blocks_cover_every_seed_once(seeds, per_job):
    configuration = load_configuration(
        "smoke", [f"budget.seeds={seeds}", f"budget.seeds_per_job={per_job}"]
    )
    covered = Counter(
        (run.task.name, run.method, run.population, run.plasticity.learning_rate, run.seed)
        for block in blocks(configuration)
        for run in run_specs(configuration, block)
    )
    assert len(covered) == len(cells(configuration)) * seeds
    assert set(covered.values()) == {1}
    assert {key[-1] for key in covered} == set(range(seeds))
    assert max(len(block.seeds) for block in blocks(configuration)) <= per_job


def test_each_task_may_have_blocks_of_its_own_size(paper):
    sizes = {(block.cell.task, len(block.seeds)) for block in blocks(paper)}
    assert sizes == {("cartpole", 30), ("lunar_lander", 10), ("hopper", 3), ("bipedal_walker", 3)}


def test_a_block_s_runs_are_those_of_its_cell(paper):
    block = next(block for block in blocks(paper) if block.first == 3)
    runs = run_specs(paper, block)
    assert [run.seed for run in runs] == list(block.seeds) == [3, 4, 5]
    assert {run.plasticity.learning_rate for run in runs} == {block.cell.learning_rate}
    assert {run.generations for run in runs} == {500}


@pytest.mark.parametrize("table", [3, 4])
def test_the_paper_s_budget_has_all_its_configurations(paper, table):
    assert len(paper_cells(paper, table)) == 16


def test_the_paper_s_configurations_where_a_budget_has_them():
    desk = paper_cells(load_configuration("desk"), 3)
    assert desk["lunar_lander", "bcm"] == Cell("lunar_lander", "bcm", 300, 0.25)
    assert desk["hopper", "neat"] == Cell("hopper", "neat", 300, None)
    assert len(desk) == 16
    demo = paper_cells(load_configuration("demo"), 3)
    assert set(demo) == {("cartpole", "neat")}  # P = 50; the rules' 2.5e-4 is not in it
    assert paper_cells(load_configuration("smoke"), 3) == {}
