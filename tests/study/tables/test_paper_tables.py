"""Printed entries of the tables, and the files that they write."""

import csv
import hashlib
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from neol.pictures.labels import METHOD_LABELS
from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import Cell
from neol.study.campaign.shown import select
from neol.study.outcomes import paper_numbers
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.score import PAPER_GENERATIONS, PAPER_POPULATION, PAPER_SAMPLES
from neol.study.outcomes.statistics import ALPHA
from neol.study.output.captions import describe_budget, describe_reading, lacking
from neol.study.tables.paper_tables import (
    CHOSEN_OF_FOUR,
    lead_over_neat,
    table1,
    table2,
    table3,
    table4,
    table5,
    table6,
    table7,
    table8,
)
from neol.study.tables.table import Table
from tests.helpers.made_up import configuration, write_campaign

BEST = Cell("cartpole", "oja", 12, 0.0025)
SECOND = Cell("cartpole", "neat", 6, None)
ALL = (table1, table2, table3, table4, table5, table6, table7, table8)
VALUES = {BEST: [2.0, 4.0, 9.0], SECOND: [1.0, 2.0, 3.0]}


@pytest.fixture
def campaign(tmp_path: Path) -> Campaign:
    constants = configuration()
    write_campaign(tmp_path / "results", constants, VALUES, otherwise=-1.5)
    return Campaign(constants, tmp_path / "results")


def row(table: Table, label: str) -> str:
    (line,) = re.findall(rf"^.*{label} &.*$", table.latex(), re.MULTILINE)
    return str(line).strip()


def test_table_1_prints_as_the_paper_does(campaign: Campaign) -> None:
    assert row(table1(campaign), "CartPole") == (
        r"CartPole & $-$1.50 $\pm$ 0.00 & $-$1.50 $\pm$ 0.00 & \textbf{5.00 $\pm$ 3.61} & "
        r"\underline{2.00 $\pm$ 1.00} \\"
    )
    assert row(table1(campaign), "paper").count(r"\textbf{500.00 $\pm$ 0.00}") == 4
    assert r"\underline" not in row(table1(campaign), "paper")


def test_table_3_prints_as_the_paper_does(campaign: Campaign) -> None:
    assert row(table3(campaign), "CartPole") == (
        r"CartPole & pop=6, lr=0.0025 & pop=6, lr=0.0025 & pop=12, lr=0.0025 & pop=6 \\"
    )
    assert "pop=50, lr=0.00025" in row(table3(campaign), "paper")


def test_braces_and_rules_balance(campaign: Campaign) -> None:
    for make in ALL:
        latex = make(campaign).latex()
        assert latex.count("{") == latex.count("}")
        assert all(latex.count(rule) == 1 for rule in ("\\toprule", "\\midrule", "\\bottomrule"))
        assert not re.search(r"(?<!\\)[%#_]", latex)


def test_the_csv_has_full_precision(campaign: Campaign, tmp_path: Path) -> None:
    table1(campaign).write(tmp_path)
    with (tmp_path / "table1.csv").open(newline="") as file:
        rows = {line["method"]: line for line in csv.DictReader(file)}
    assert float(rows["oja"]["sd"]) == 13.0**0.5
    assert (rows["oja"]["population"], rows["oja"]["paper_mean"]) == ("12", "500.0")


def test_the_sidecar_leads_back_to_the_records(campaign: Campaign, tmp_path: Path) -> None:
    table1(campaign).write(tmp_path / "figures")
    sidecar = json.loads((tmp_path / "figures" / "table1.json").read_text())
    assert sidecar["budget"] == "smoke"
    assert sidecar["command"].startswith("snakemake ")
    assert sidecar["command"].endswith("figures/table1.tex --config budget=smoke tasks=cartpole")
    assert len(sidecar["records"]) == 14  # three rules of four cells, NEAT of two; not NEAT (w/o)
    for record in sidecar["records"]:
        content = (tmp_path / record["path"]).read_bytes()
        assert hashlib.sha256(content).hexdigest() == record["sha256"]
        assert list(record["runs"]) == ["0", "1", "2"]


def test_a_missing_seed_is_marked_and_noted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    constants = configuration()
    write_campaign(tmp_path, constants, VALUES | {BEST: [2.0, None, 9.0]})
    table = table1(Campaign(constants, tmp_path))
    assert "0.00 $\\pm$ 0.00 (a)" in row(table, "CartPole")
    assert table.notes[0] == "(a) chosen among the 3 of 4 cells that are complete."
    assert table.notes[0] in table.latex()
    assert table.notes[0] in table._repr_html_()
    said = "neol: cartpole/oja/p012_lr0.0025: no record of seeds 1"
    assert capsys.readouterr().err.splitlines() == [said]


def test_what_a_budget_lacks_is_counted(campaign: Campaign, tmp_path: Path) -> None:
    assert lacking(campaign) == ""
    constants = configuration()
    write_campaign(tmp_path / "fewer", constants, {BEST: [2.0, None, 9.0], SECOND: [None] * 3})
    assert lacking(Campaign(constants, tmp_path / "fewer")) == (
        "Seeds are missing: 2 of 16 cells are incomplete, 4 of 48 runs are not there."
    )


def test_the_notes_on_contradictions_say_what_the_paper_prints() -> None:
    fitness, scores, ablation = (paper_numbers.values(table) for table in (1, 2, 8))
    methods = [method for method in METHOD_LABELS if method != "neat_wo"]
    assert {fitness["cartpole", method][0] for method in methods} == {500}
    walker = {method: fitness["bipedal_walker", method] for method in ("bcm", "oja", "neat")}
    assert min(walker["bcm"][1], walker["oja"][1]) > walker["neat"][1]
    assert walker["neat"][0] == 183.36
    assert "183.36" in paper_numbers.CONTRADICTIONS[1][0]
    assert round(0.745 * PAPER_SAMPLES / (PAPER_GENERATIONS * PAPER_POPULATION)) == 497
    assert scores["cartpole", "neat"][0] < 0.745 < scores["cartpole", "hebb"][0]
    assert ablation["bipedal_walker", "hebb"][0] < ablation["bipedal_walker", "neat_wo"][0]


def test_how_often_the_best_of_four_cells_seems_better_than_an_equal() -> None:
    random = np.random.default_rng(0)
    cells = random.normal(size=(3000, 4, 30))
    chosen = cells[np.arange(len(cells)), cells.mean(axis=-1).argmax(axis=-1)]
    against = random.normal(size=(len(cells), 30))
    p = stats.mannwhitneyu(chosen, against, axis=1).pvalue
    higher = chosen.mean(axis=1) > against.mean(axis=1)
    assert ((p < ALPHA) & higher).mean() == pytest.approx(CHOSEN_OF_FOUR, abs=0.012)


def test_tables_say_that_a_choice_flatters(campaign: Campaign, tmp_path: Path) -> None:
    for make in (table1, table2, table5, table6, table7, table8):
        assert any("the best of up to" in note for note in make(campaign).notes)
    paper = Campaign(load_configuration("paper"), tmp_path / "none")
    assert "the best of up to 4, NEAT's of 1," in " ".join(table6(paper).notes)
    assert not any("the best of" in note for note in table5(paper).notes)


def test_no_record_at_all_prints_nothing_but_the_reasons(tmp_path: Path) -> None:
    table = table1(Campaign(configuration(), tmp_path))
    assert row(table, "CartPole") == r"CartPole & -- (a) & -- (a) & -- (a) & -- (b) \\"
    assert table.sources == ()


def test_the_caption_says_the_budget(campaign: Campaign) -> None:
    caption = table1(campaign).caption
    assert (
        "Budget smoke, CartPole only: G = 2 generations, 3 seeds, N = 1 episode per evaluation"
        in caption
    )
    assert caption.endswith(
        "Reduced budget: not the paper's. Reading rare_mutation: evaluation.held_out_episodes = 1 "
        "instead of 5."
    )
    of_first = describe_reading(select("smoke", "cartpole", "first"))
    assert of_first.startswith("Reading first: plasticity.reward_scale = 0.01 instead of 1.0, ")


def test_only_the_papers_budget_is_the_papers() -> None:
    assert "Reduced" not in describe_budget(load_configuration("paper"))
    assert describe_budget(select("paper", "hopper,lunar_lander,cartpole")).startswith(
        "Budget paper, CartPole, Lunar Lander and Hopper only: G = 500 generations, 30 seeds, "
    )
    assert "Reduced" not in describe_budget(select("paper", "cartpole"))
    part = describe_budget(load_configuration("paper", ["budget.seeds=29"]))
    assert "A part of the paper's budget: 29 of 30 seeds." in part
    assert "Reduced" in describe_budget(load_configuration("paper", ["budget.generations=499"]))
    assert "Reduced" in describe_budget(load_configuration("paper", ["neat.elitism=3"]))


def test_tasks_of_different_size_are_told_apart() -> None:
    overrides = [
        "budget.generations={cartpole: 500, lunar_lander: 500, hopper: 60, bipedal_walker: 60}",
        "budget.seeds={cartpole: 30, lunar_lander: 10, hopper: 5, bipedal_walker: 5}",
    ]
    caption = describe_budget(load_configuration("paper", overrides))
    assert "30 (CartPole), 10 (Lunar Lander), 5 (Hopper, Bipedal Walker) seeds" in caption
    assert (
        "The paper's budget (CartPole), a part of the paper's budget: 10 of 30 seeds (Lunar "
        "Lander), reduced budget: not the paper's (Hopper, Bipedal Walker)." in caption
    )


def test_a_part_of_the_papers_budget_says_which() -> None:
    landing = describe_budget(select("evidence", "lunar_lander", "worked_example"))
    assert "A part of the paper's budget: P = 300. Rea" in landing
    changes = ["budget.tasks=[cartpole]", "budget.populations=[50]", "budget.configurations=tables"]
    balancing = describe_budget(load_configuration("evidence", changes))
    assert "budget: P = 50, the configurations of Tables 3 and 4. Rea" in balancing
    assert "Reduced" not in landing + balancing
    assert "budget:" not in describe_budget(select("evidence", "cartpole"))


class TestOtherTables:
    """Oja, population 12, lr 0.0025 ends at 2, 4, 9; NEAT, population 6, at 1, 2, 3; others -1.5.

    Two generations, the first 1 higher. M = 1e8 x 2 x 12 / 150,000 = 16,000.
    """

    def test_table_2_is_score_at_the_largest_population(self, campaign: Campaign) -> None:
        """Oja: 12 / 16,000 x (5, 9, 19), of mean 11; the others 12 / 16,000 x -2."""
        table = table2(campaign)
        assert r"\textbf{0.00825 $\pm$ 0.00541}" in row(table, "CartPole")
        assert row(table, "CartPole").count(r"\underline{$-$0.00150 $\pm$ 0.00}") == 3
        assert r"\underline{0.746 $\pm$ 0.00908}" in row(table, "paper")
        assert "at population 12" in table.caption
        assert "M = 1.6e4" in table.caption

    def test_tables_4_and_7_have_neat_without_weight_mutation(self, campaign: Campaign) -> None:
        assert row(table7(campaign), "CartPole").endswith(
            r"\textbf{5.00 $\pm$ 3.61} & \underline{$-$1.50 $\pm$ 0.00} \\"
        )
        assert row(table4(campaign), "CartPole").endswith(r"pop=12, lr=0.0025 & pop=6 \\")
        assert table7(campaign).columns[-1] == "NEAT (w/o)"

    def test_table_8_compares_score_with_neat_without_weight_mutation(
        self, campaign: Campaign
    ) -> None:
        assert r"\textbf{0.00825 $\pm$ 0.00541}" in row(table8(campaign), "CartPole")
        assert r"\underline{0.746 $\pm$ 0.00959}" in row(table8(campaign), "paper")

    def test_table_5_by_hand(self, campaign: Campaign) -> None:
        """Oja (2, 4, 9) against NEAT (1, 2, 3): 7.5 of 9 pairs; the rules at -1.5 win none."""
        frame = table5(campaign).frame.set_index("method")
        assert frame.loc["oja", "a12"] == pytest.approx(7.5 / 9)
        assert frame.loc["bcm", "a12"] == 0
        z = (7.5 - 4.5 - 0.5) / (0.75 * (7 - 6 / 30)) ** 0.5  # one tie of two among six
        assert frame.loc["oja", "p"] == pytest.approx(math.erfc(z / 2**0.5))
        assert frame.loc["oja", "difference"] == 3

    def test_table_5_prints_as_the_paper_does(self, tmp_path: Path) -> None:
        constants = configuration(tasks=("hopper",), seeds=4)
        better = {
            Cell("hopper", method, 12, 0.25): [5.0, 6.0, 7.0, 8.0] for method in ("bcm", "hebb")
        }
        neat = {Cell("hopper", "neat", 6, None): [1.0, 2.0, 3.0, 4.0]}
        write_campaign(tmp_path, constants, better | neat, otherwise=-9.0)
        table = table5(Campaign(constants, tmp_path))
        bold = r"\textbf{2.86e$-$2}"  # 2 / 70
        lower = r"\textbf{2.11e$-$2}"  # Oja's ties, all below NEAT
        assert row(table, "Hopper") == rf"Hopper & {bold} & {bold} & {lower} \\"
        assert r"\footnotesize 5.746e$-$2" in row(table, "paper")
        assert any("two-sided" in note for note in table.notes)
        assert table.frame["paper_a12"].tolist() == [663 / 900, 579 / 900, 615 / 900]

    def test_table_6_tests_score(self, campaign: Campaign) -> None:
        """NEAT is one of the others at population 12."""
        assert table6(campaign).frame.set_index("method").loc["oja", "a12"] == 1

    def test_the_lead_over_neat(self, campaign: Campaign) -> None:
        assert lead_over_neat(table1(campaign)).loc["CartPole", ("Oja", "here")] == 3.0

    def test_no_record_at_all(self, tmp_path: Path) -> None:
        for make in ALL:
            table = make(Campaign(configuration(), tmp_path))
            assert "-- (" in row(table, "CartPole")
