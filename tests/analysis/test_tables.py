"""What the tables print, and the files that they leave."""

import csv
import hashlib
import json
import re
from pathlib import Path

import pytest

from neol.analysis.runs import Campaign
from neol.analysis.tables import Table, describe_budget, table1, table3
from neol.campaign import Cell
from neol.spec import load_configuration
from tests.analysis.made_up import configuration, write_campaign

BEST = Cell("cartpole", "oja", 12, 0.0025)
SECOND = Cell("cartpole", "neat", 6, None)
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
    for table in (table1(campaign), table3(campaign)):
        latex = table.latex()
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
    assert sidecar["command"].endswith("figures/table1.tex --config budget=smoke")
    assert len(sidecar["records"]) == 14  # three rules of four cells, NEAT of two; not NEAT (w/o)
    for record in sidecar["records"]:
        content = (tmp_path / record["path"]).read_bytes()
        assert hashlib.sha256(content).hexdigest() == record["sha256"]
        assert list(record["runs"]) == ["0", "1", "2"]


def test_a_missing_seed_is_marked_and_noted(tmp_path: Path) -> None:
    constants = configuration()
    write_campaign(tmp_path, constants, VALUES | {BEST: [2.0, None, 9.0]})
    table = table1(Campaign(constants, tmp_path))
    assert "0.00 $\\pm$ 0.00 (a)" in row(table, "CartPole")
    assert table.notes == ("(a) chosen among the 3 of 4 cells that are complete.",)
    assert table.notes[0] in table.latex()
    assert table.notes[0] in table._repr_html_()


def test_no_record_at_all_prints_nothing_but_the_reasons(tmp_path: Path) -> None:
    table = table1(Campaign(configuration(), tmp_path))
    assert row(table, "CartPole") == r"CartPole & -- (a) & -- (a) & -- (a) & -- (b) \\"
    assert table.sources == ()


def test_the_caption_says_the_budget(campaign: Campaign) -> None:
    caption = table1(campaign).caption
    assert "Budget smoke: G = 2 generations, 3 seeds, N = 1 episode per evaluation" in caption
    assert caption.endswith("Reduced budget: not the paper's.")


def test_only_the_papers_budget_is_the_papers() -> None:
    assert "Reduced" not in describe_budget(load_configuration("paper"))
    assert "Reduced" in describe_budget(load_configuration("paper", ["budget.seeds=29"]))
    assert "Reduced" in describe_budget(load_configuration("paper", ["neat.elitism=3"]))
