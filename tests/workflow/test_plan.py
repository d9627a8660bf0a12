"""What the workflow plans and what it refuses, before anything has run."""

from pathlib import Path

import pytest

from neol.campaign import blocks
from neol.sensitivity import variants
from neol.spec import load_configuration
from tests.workflow.clone import fresh_clone, planned, snakemake

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fresh_clone(tmp_path_factory.mktemp("plan") / "neol")


def test_everything_of_the_papers_budget(clone: Path) -> None:
    jobs = len(blocks(load_configuration("paper")))
    plan = planned(clone, "all", "--config", "budget=paper")
    assert plan["run"] == jobs
    assert sum(rule.endswith("_notebook") for rule in plan) == 7
    assert sum(rule.startswith("sensitivity_") for rule in plan) == len(variants())


def test_table_1_of_the_papers_budget_needs_only_the_papers_configurations(clone: Path) -> None:
    budget = load_configuration("paper").budget
    jobs = 16 * budget.seeds // budget.seeds_per_job
    target = "figures/paper/table1.tex"
    assert planned(clone, target, "--config", "budget=paper") == {"run": jobs, "tables_notebook": 1}


def test_every_table_and_figure_is_a_target(clone: Path) -> None:
    tables = [f"figures/table{number}.{kind}" for number in range(1, 9) for kind in ("tex", "csv")]
    figures = [
        f"figures/figure{number}.{kind}" for number in range(2, 12) for kind in ("pdf", "png")
    ]
    assert planned(clone, *tables, *figures) == planned(clone, "tables", "figures")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["tables", "--config", "budget=dusk"], 'unknown budget "dusk", did you mean "desk"?'),
        (["tables", "--config", "bugdet=desk"], "--config bugdet: unknown key (allowed: budget)"),
        (["figures/table1.tex", "--config", "budget=desk"], "ask for figures/desk/table1.tex"),
        (["figures/desk/table1.tex"], "shows budget desk: add --config budget=desk"),
        (["figures/smoke/table1.tex"], "ask for figures/table1.tex"),
        (["results/smoke/cartpole/nix.parquet"], "budget smoke has no such record"),
    ],
)
def test_what_cannot_be_made_is_refused_in_one_line(
    clone: Path, arguments: list[str], line: str
) -> None:
    result = snakemake(clone, "--dry-run", *arguments)
    (said,) = [text for text in result.stderr.splitlines() if not text.startswith("Using workflow")]
    assert result.returncode != 0
    assert said.startswith("neol: ")
    assert line in said
