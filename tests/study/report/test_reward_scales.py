"""What each beta makes of the paper's statements, from made-up records."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import Cell, blocks, run_specs
from neol.study.report.reward_scales import (
    NOT_RUN,
    at_each_beta,
    reward_scales,
    what_learning_adds,
)
from tests.helpers.made_up import run, write_runs

READING = "worked_example"
"""A reading with beta = 1."""


def write(results: Path, reading: str, finals: Mapping[Cell, Sequence[float]]) -> None:
    """Write each cell's first record, with runs that end at these values."""
    configuration = load_configuration("paper", reading=reading)
    for cell, ends in finals.items():
        block = next(each for each in blocks(configuration) if each.cell == cell)
        specs = run_specs(configuration, block)
        values = (ends[each % len(ends)] for each in range(len(specs)))
        runs = [
            run(spec, "paper", end, configuration.reading)
            for spec, end in zip(specs, values, strict=True)
        ]
        write_runs(results / block.record, runs)


def lander(method: str, rate: float | None) -> Cell:
    return Cell("lunar_lander", method, 300, rate)


def test_without_runs_nothing_is_said(tmp_path: Path) -> None:
    _, *rows = reward_scales(READING, tmp_path)
    assert rows == [[beta, NOT_RUN, NOT_RUN, NOT_RUN] for beta in ("1 (default)", "0.1", "0.01")]


def test_a_lead_of_hebb_is_compared_with_the_papers(tmp_path: Path) -> None:
    write(tmp_path, READING, {lander("neat_wo", None): [300, 302]})
    for ends, said in (
        ([310, 312], "seen: +10.0"),
        ([290, 292], "contradicted: -10.0"),
        ([280, 320], "open: -1.0"),
    ):
        write(tmp_path, READING, {lander("hebb", 0.00025): ends})
        assert reward_scales(READING, tmp_path)[1][1].startswith(said)


def test_the_rates_are_compared_under_every_beta_with_the_same_products(tmp_path: Path) -> None:
    ends = {0.00025: [310, 312], 0.0025: [300, 302], 0.025: [290, 292], 0.25: [100, 102]}
    write(tmp_path, READING, {lander("bcm", rate): each for rate, each in ends.items()})
    _, one, tenth, hundredth = (row[2] for row in reward_scales(READING, tmp_path))
    assert one.startswith("contradicted: 0.00025: 311 ± 1; 0.0025: 301 ± 1; 0.025: 291 ± 1")
    assert tenth == "contradicted: 0.0025: 311 ± 1; 0.025: 301 ± 1; 0.25: 291 ± 1"
    assert hundredth == "contradicted: 0.025: 311 ± 1; 0.25: 301 ± 1"


def test_the_best_rate_is_seen_only_among_all(tmp_path: Path) -> None:
    write(tmp_path, READING, {lander("bcm", 0.025): [290, 292], lander("bcm", 0.25): [300, 302]})
    assert reward_scales(READING, tmp_path)[1][2] == "open: 0.025: 291 ± 1; 0.25: 301 ± 1"


def test_runs_under_that_beta_are_found(tmp_path: Path) -> None:
    write(tmp_path, READING, {lander("neat_wo", None): [300, 302]})
    reading = f"{READING}+plasticity.reward_scale=0.1"
    write(tmp_path, reading, {lander("hebb", 0.00025): [310, 312]})
    assert [row[1][:4] for row in reward_scales(READING, tmp_path)[1:]] == ["not ", "seen", "not "]


def test_the_runs_at_cartpoles_ceiling_are_counted(tmp_path: Path) -> None:
    cells = {rule: Cell("cartpole", rule, 50, 0.25) for rule in ("hebb", "oja", "bcm")}
    write(tmp_path, READING, {cells["hebb"]: [500], cells["oja"]: [500, 400], cells["bcm"]: [500]})
    said = "seen: at the ceiling end Oja 15 of 30, Hebb 30 of 30, BCM 30 of 30"
    assert reward_scales(READING, tmp_path)[1][3] == said


def test_what_learning_adds_is_a_difference_from_neat_without_weight_mutation(
    tmp_path: Path,
) -> None:
    """A rate under a beta is found at another rate, under another beta of the same product."""
    write(
        tmp_path, READING, {lander("neat_wo", None): [300, 302], lander("bcm", 0.025): [290, 292]}
    )
    reading = f"{READING}+plasticity.reward_scale=0.1"
    write(tmp_path, reading, {lander("oja", 0.00025): [310, 312]})
    head, one, tenth, hundredth, paper = what_learning_adds(READING, tmp_path)
    assert head == ["beta", "BCM", "Hebb", "Oja"]
    assert one == ["1 (default)", NOT_RUN, NOT_RUN, NOT_RUN]
    assert tenth == ["0.1", "-10.0 [-11.0, -9.0], 10 runs", NOT_RUN, NOT_RUN]
    assert hundredth == ["0.01", NOT_RUN, NOT_RUN, "+10.0 [9.0, 11.0], 10 runs"]
    assert paper[2] == "+10.9 [7.3, 14.4]"


def test_in_short_each_beta_that_has_all_its_runs_is_named(tmp_path: Path) -> None:
    ends = {
        lander("neat_wo", None): [300, 302],
        lander("hebb", 0.00025): [290, 292],
        **{lander("oja", rate): [300, 304] for rate in (0.00025, 0.0025)},
        **{lander("bcm", rate): [200, 202] for rate in (0.025, 0.25)},
    }
    write(tmp_path, READING, ends)
    papers = load_configuration("paper", reading=READING)
    assert at_each_beta(papers, tmp_path) == "", "only beta = 1 has its runs"
    reading = f"{READING}+plasticity.reward_scale=0.1"
    write(tmp_path, reading, {lander("hebb", 0.00025): [310, 312]})
    said = at_each_beta(papers, tmp_path)
    assert "is, at beta = 1 and 0.1: BCM -100 and -100 (the paper: 11.8); Hebb -10.0 and 10" in said
    assert said.endswith("above NEAT (w/o): Hebb at 0.1. Below: BCM at 1 and 0.1; Hebb at 1.")
    assert at_each_beta(load_configuration("demo", reading=READING), tmp_path) == ""
