"""Everything, once, from nothing: the smallest budget in a fresh clone, with page and paper."""

import hashlib
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from neol.analysis.labels import HEATMAPS
from neol.report.page import BEYOND
from neol.trace import trace
from tests.report.test_page import Outline
from tests.workflow.clone import FIGURES, SMOKE, fresh_clone, planned, snakemake

pytestmark = pytest.mark.slow

PAPER = ("paper" if FIGURES.name == "figures" else FIGURES) / Path("reproduction.pdf")
HAS_LATEX = shutil.which("latexmk") is not None
NEEDS_LATEX = pytest.mark.skipif(not HAS_LATEX, reason="no LaTeX on this machine")
TABLES = [*(f"table{number}" for number in range(1, 9)), "claims"]
PICTURES = [
    *(f"figure{number}" for number in (2, 3, *HEATMAPS)),
    *(f"beyond_{name}" for name in BEYOND),
]


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    clone = fresh_clone(tmp_path_factory.mktemp("all") / "neol")
    made = snakemake(clone, "all", *([str(PAPER)] if HAS_LATEX else []), *SMOKE)
    assert made.returncode == 0, made.stdout[-4000:] + made.stderr[-4000:]
    return clone


def test_every_table_and_figure_is_there_and_traced(clone: Path) -> None:
    for names, kinds in ((TABLES, ("tex", "csv")), (PICTURES, ("pdf", "png"))):
        for name in names:
            for kind in kinds:
                lines = list(trace(clone / FIGURES / f"{name}.{kind}", clone))
                assert not [line for line in lines if line.endswith(("since)", "here)"))]


def test_a_second_call_has_nothing_to_do(clone: Path) -> None:
    assert planned(clone, "all", *SMOKE) == {}


def test_the_page_is_whole(clone: Path) -> None:
    outline = Outline((clone / FIGURES / "report.html").read_text(encoding="utf-8"))
    assert {link.removeprefix("#") for link in outline.links} <= outline.ids.keys()
    assert {*TABLES, *PICTURES, "champion-hopper"} <= outline.ids.keys()
    assert all(source.startswith("data:image/") for source in outline.sources)


def test_snakemake_reports_with_captions(clone: Path) -> None:
    made = snakemake(clone, "--report", "snakemake.html", "tables", "figures", *SMOKE)
    assert made.returncode == 0, made.stderr
    caption = (clone / "paper/captions/figure2.rst").read_text().strip()
    assert json.dumps(caption)[1:-1] in (clone / "snakemake.html").read_text()


@NEEDS_LATEX
def test_the_paper_is_about_eight_pages_and_refers_to_what_is_there(clone: Path) -> None:
    log = (clone / "build/smoke/paper/reproduction.log").read_text(errors="replace")
    written = re.search(r"Output written on .*\((\d+)\s+pages", log.replace("\n", ""))
    assert written
    assert 7 <= int(written[1]) <= 12
    assert "undefined" not in log


@NEEDS_LATEX
def test_the_paper_comes_out_the_same_again(clone: Path) -> None:
    before = hashlib.sha256((clone / PAPER).read_bytes()).hexdigest()
    shutil.rmtree(clone / "build/smoke/paper")
    made = snakemake(clone, str(PAPER), *SMOKE)
    assert made.returncode == 0, made.stderr
    assert hashlib.sha256((clone / PAPER).read_bytes()).hexdigest() == before


def test_without_latex_the_paper_says_what_to_install(clone: Path, tmp_path: Path) -> None:
    for tool in ("bash", "dirname", "env"):
        (tmp_path / tool).symlink_to(shutil.which(tool) or "")
    command = ["paper/build.sh", "paper/reproduction.tex", "build/results.tex", "out.pdf"]
    ran = subprocess.run(
        command, cwd=clone, env={"PATH": str(tmp_path)}, capture_output=True, text=True
    )
    assert ran.returncode == 1
    assert re.fullmatch(r"neol: out\.pdf needs LaTeX.*apt install latexmk .*\n", ran.stderr)
    assert not (clone / "out.pdf").exists()
