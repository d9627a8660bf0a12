"""Names of files and values of records are shown as text: no markup, no escape of a terminal."""

import shutil
from pathlib import Path

from neol.spec.configuration import ROOT
from neol.study.verification.check import Problem
from tests.helpers.command import neol

RECORD = ROOT / "results/rare_mutation/demo/cartpole/neat/p050/seeds_000-004.parquet"


def test_compare_shows_names_as_text(tmp_path: Path) -> None:
    name = "[bold]a[slash]\x1b[31m.parquet"
    for each in (name, "b.parquet"):
        shutil.copy(RECORD, tmp_path / each)
    shown = neol("compare", tmp_path / name, tmp_path / "b.parquet").stdout
    assert "[bold]a[slash]\\x1b[31m.parquet" in shown
    assert "\x1b" not in shown


def test_a_finding_is_one_line_of_text() -> None:
    line = str(Problem(Path("a\nb"), "edited \x1b[31m"))
    assert line == "a\\nb: edited \\x1b[31m"
