"""What `neol trace` says of a table."""

import json
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.output.sidecar import trace
from neol.study.tables.paper_tables import table3
from tests.helpers.command import neol
from tests.helpers.made_up import configuration, write_campaign


@pytest.fixture
def table(tmp_path: Path) -> Path:
    constants = configuration()
    write_campaign(tmp_path / "results", constants, {})
    table3(Campaign(constants, tmp_path / "results")).write(tmp_path / "figures")
    return tmp_path / "figures" / "table3.tex"


def test_a_table_is_traced_to_its_runs(table: Path) -> None:
    lines = list(trace(table, table.parent.parent))
    assert lines[:3] == ["table3.tex", "table3.csv", "table3.md"]
    assert lines[3].endswith("figures/table3.tex --config budget=smoke tasks=cartpole")
    assert lines[5].startswith("reading  rare_mutation (evaluation.held_out")
    assert "records  14, of 42 runs" in lines
    assert sum(line.startswith("  seed ") for line in lines) == 42
    assert "results/rare_mutation/smoke/cartpole/neat/p006/seeds_000-002.parquet" in lines


def test_what_has_become_of_an_output_is_said(table: Path) -> None:
    table.write_text("edited by hand")
    assert list(trace(table, table.parent.parent))[:2] == [
        "table3.tex  (changed since)",
        "table3.csv",
    ]


def test_what_has_become_of_a_record_is_said(table: Path) -> None:
    folder = table.parent.parent / "results/rare_mutation/smoke/cartpole/neat"
    (folder / "p006/seeds_000-002.parquet").write_bytes(b"other")
    (folder / "p012/seeds_000-002.parquet").unlink()
    lines = trace(table, table.parent.parent)
    states = [line for line in lines if line.startswith("results/") and line.endswith(")")]
    assert [line.partition("  ")[2] for line in states] == ["(changed since)", "(not here)"]


@pytest.mark.parametrize("name", ["", "a/b", "..", "\0", "x" * 5000])
def test_names_that_are_none_are_not_here(table: Path, name: str) -> None:
    sidecar = json.loads(table.with_suffix(".json").read_text())
    sidecar["outputs"][name] = "0" * 64
    sidecar["records"][0]["path"] = name
    table.with_suffix(".json").write_text(json.dumps(sidecar))
    lines = list(trace(table, table.parent.parent))
    assert lines.count(f"{name}  (not here)") == 2


def test_what_cannot_be_traced_is_said_in_one_line(table: Path) -> None:
    folder = table.parent
    for name in ("nothing.tex", "table3.log", "run.parquet"):
        (folder / name).touch()
    for name, line in (
        ("none.tex", "none.tex: no such file"),
        ("table3.pdf", "table3.pdf: no such file"),
        ("nothing.tex", "nothing.tex: has no nothing.json beside it"),
        ("table3.log", "table3.log: not one of the files that table3.json lists"),
        ("run.parquet", "run.parquet: a record, .* neol digest"),
    ):
        with pytest.raises(UserError, match=line):
            list(trace(folder / name))
    table.with_suffix(".json").write_text('{"records": 3}')
    with pytest.raises(UserError, match=r"table3\.json: damaged, or made by another version"):
        list(trace(table))


def test_the_command(table: Path) -> None:
    result = neol("trace", table)
    assert result.exit_code == 0
    assert "records  14, of 42 runs" in result.output
