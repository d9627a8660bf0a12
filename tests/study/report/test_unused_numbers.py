"""NEAT's numbers that the search did not use, from made-up records."""

from pathlib import Path

from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import Cell, blocks, run_specs
from neol.study.report.unused_numbers import unused_numbers
from tests.helpers.made_up import run, write_runs

SEEN, UNSEEN = (Cell("lunar_lander", "neat", population, None) for population in (300, 50))
HOPPER = Cell("hopper", "neat_wo", 300, None)


def write(results: Path, *cells: Cell) -> None:
    """Write each cell's first record: its best fitness falls to 100, 101, ... by seed."""
    configuration = load_configuration("paper", reading="first")
    for cell in cells:
        block = next(each for each in blocks(configuration) if each.cell == cell)
        specs = run_specs(configuration, block)
        runs = [run(spec, "paper", 100.0 + spec.seed, "first") for spec in specs]
        write_runs(results / block.record, runs)


def test_numbers_that_the_search_used_are_left_out(tmp_path: Path) -> None:
    write(tmp_path, SEEN)
    assert unused_numbers("first", tmp_path) == []


def test_finals_are_counted_in_both_ways_beside_the_papers(tmp_path: Path) -> None:
    write(tmp_path, SEEN, UNSEEN, HOPPER)
    _, lander, hopper = unused_numbers("first", tmp_path)
    finals = "104 ± 3 / 604 ± 3 (10)"  # 100 to 109, and 499 more in the first generation
    assert lander == ["Lunar Lander", "NEAT", finals, "", "", "", "312 ± 8 (P = 300)"]
    assert hopper[:2] == ["Hopper", "NEAT (w/o)"]
    assert hopper[5] == "101 ± 1 / 600 ± 1 (3)"


def test_the_papers_number_has_the_papers_population(tmp_path: Path) -> None:
    write(tmp_path, Cell("bipedal_walker", "neat", 50, None))
    _, walker = unused_numbers("first", tmp_path)
    assert walker[-1] == "183 ± 72 (P = 100)"  # Tables 1 and 3
