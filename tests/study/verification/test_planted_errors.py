"""Planted errors: every kind is found, by the check that the table in the docs names.

`python -m tests.study.verification.test_planted_errors` writes that table.
"""

import contextlib
import re
import shutil
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT
from tests.helpers.command import neol
from tests.run.test_digests import SAME_LAST_BITS
from tests.study.verification.campaign import OJA, make_campaign, patch_budget
from tests.study.verification.planted import PLANTS
from tests.study.verification.planted.plant import Plant

PAGE = ROOT / "docs" / "planted-errors.md"
TABLE = re.compile(r"(?<=<!-- planted errors -->\n).*(?=<!-- end -->)", re.DOTALL)
LONGEST = 160
EVERY = [
    pytest.param(plant, id=f"{kind[:8]}-{plant.kind}")
    for kind, plants in PLANTS.items()
    for plant in plants
]


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with _campaign(tmp_path_factory.mktemp("results")) as folder:
        yield folder


@contextlib.contextmanager
def _campaign(parent: Path) -> Iterator[Path]:
    """A small campaign, from a machine that is always the same."""
    with patch_budget():
        make_campaign(parent / "original")
        yield parent / "original"


@cache
def findings(campaign: Path, plant: Plant | None, options: str) -> tuple[int, list[str]]:
    """Exit code and lines of `neol verify` on a copy of the campaign with an error in it."""
    with tempfile.TemporaryDirectory(dir=campaign.parent) as parent:
        folder = Path(parent, "smoke")
        shutil.copytree(campaign, folder)
        if plant is not None:
            plant.do(folder)
        outcome = neol(f"verify --seed 0 {options}", folder)
        *lines, summary = outcome.stdout.splitlines()
        count = {0: "all well", 1: "1 finding"}.get(len(lines), f"{len(lines)} findings")
        assert summary.endswith(count)
        return outcome.exit_code, [line.replace(str(folder), "results/smoke") for line in lines]


@pytest.mark.parametrize("options", ["", "--replay 9 --replay-champions 9"])
def test_nothing_is_found_where_nothing_is_wrong(campaign: Path, options: str) -> None:
    assert findings(campaign, None, options) == (0, [])


@pytest.mark.parametrize("plant", EVERY)
def test_every_kind_is_found(campaign: Path, plant: Plant) -> None:
    code, lines = findings(campaign, plant, plant.options)
    assert code == 3
    assert lines
    if plant.options:
        assert findings(campaign, plant, "") == (0, [])


@pytest.mark.skipif(not SAME_LAST_BITS, reason="values were printed on x86-64 Linux with glibc")
def test_the_table_in_the_docs_is_up_to_date(campaign: Path) -> None:
    (written,) = TABLE.findall(PAGE.read_text(encoding="utf-8"))
    assert written == _table(campaign)


def _table(campaign: Path) -> str:
    """Every kind, what finds it and the first line that is printed, as Markdown."""
    lines = []
    for kind, plants in PLANTS.items():
        lines += ["", f"| {kind} | found by `neol verify` | in the words |", "| --- | --- | --- |"]
        for plant in plants:
            said = findings(campaign, plant, plant.options)[1][0].replace("|", "\\|")
            said = said.replace("results/smoke/", "").removeprefix(f"{OJA}: ")
            said = said if len(said) <= LONGEST else f"{said[:LONGEST]}…"
            found_by = f"`{plant.options.split()[0]}`" if plant.options else "alone"
            lines.append(f"| {plant.kind} | {found_by} | {said} |")
    return "\n".join([*lines, "", ""])


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch, _campaign(Path(scratch)) as made:
        text = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(TABLE.sub(lambda _: _table(made), text), encoding="utf-8")
