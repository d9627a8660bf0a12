"""Declarations of tables and figures agree with their files."""

import re
from collections import Counter

import pytest

from neol.spec.configuration import ROOT, load_configuration
from neol.study.campaign.grid import RESULTS, blocks
from neol.study.campaign.jobs import jobs
from neol.study.campaign.shown import select
from neol.study.figures.paper_figures import HEATMAPS
from neol.study.workflow.exhibits import EXHIBITS, GRID, TRIALS, Exhibit, exhibits, records

INDEX = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")


def test_no_two_have_the_same_files() -> None:
    assert set(Counter(each.name for each in EXHIBITS).values()) == {1}


@pytest.mark.parametrize("exhibit", EXHIBITS, ids=lambda exhibit: exhibit.name)
def test_what_it_names_is_there(exhibit: Exhibit) -> None:
    assert (ROOT / "notebooks" / f"{exhibit.notebook}.ipynb").exists()
    assert records(load_configuration("demo"), exhibit.reads)
    assert all(list(ROOT.glob(each)) for each in exhibit.files)


@pytest.mark.parametrize("exhibit", EXHIBITS, ids=lambda exhibit: exhibit.name)
def test_the_index_of_the_documentation_says_where_it_comes_from(exhibit: Exhibit) -> None:
    named = re.fullmatch(r"(table|figure)(\d+)", exhibit.name)
    first = rf"{named[1].title()}s? .*\b{named[2]}\b.*" if named else ".*"
    target = f"`snakemake {exhibit.group.target}`"
    row = rf"^\| {first} \| .* {target} \| `{exhibit.notebook}\.ipynb` \|$"
    assert re.search(row, INDEX, re.MULTILINE)


@pytest.mark.parametrize("exhibit", EXHIBITS, ids=lambda exhibit: exhibit.name)
def test_its_caption_begins_with_its_number(exhibit: Exhibit) -> None:
    if number := re.fullmatch(r"(table|figure)(\d+)", exhibit.name):
        assert exhibit.caption.startswith(f"{number[1].title()} {number[2]}: ")


def test_a_heat_map_is_of_the_task_that_is_drawn() -> None:
    declared = {each.name: each.task for each in EXHIBITS if each.notebook == "heatmaps"}
    assert declared == {f"figure{number}": task for number, (task, _) in HEATMAPS.items()}


def test_a_budget_has_the_heat_maps_of_its_tasks() -> None:
    heatmaps = [
        each for each in exhibits(select("demo", "cartpole").budget, "figures") if each.task
    ]
    assert [each.name for each in heatmaps] == ["figure4", "figure8"]


def test_which_records_are_read() -> None:
    demo = load_configuration("demo")
    every = {job.record.relative_to(RESULTS) for job in jobs(demo)}
    methods = {block.record: block.cell.method for block in blocks(demo)}
    read = {reads: set(records(demo, reads)) for reads in (GRID, TRIALS, "table3", "table4")}
    assert read[GRID] == methods.keys()
    assert read[TRIALS] == every - methods.keys()
    assert {methods[path] for path in read["table3"]} == {"bcm", "hebb", "oja", "neat"}
    assert {methods[path] for path in read["table4"]} == {"bcm", "hebb", "oja", "neat_wo"}
