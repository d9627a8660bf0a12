"""Every code block of the README and the documentation does what it says.

They run page by page, in order, in a clone whose `.venv` is the environment of these tests. Files
of a page are removed before the next one, except records and figures. A block with a title is a
file that later blocks use. Commands that would take hours are only planned.
"""

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT
from tests.workflow.clone import fresh_clone, make_records

DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCE = re.compile(r"^```(?P<info>[^\n]*)\n(?P<code>.*?)^```$", re.DOTALL | re.MULTILINE)
INFO = re.compile(r'(?P<language>bash|python|yaml|text)(?: title="(?P<title>[\w./-]+)")?$')

FOLLOWED = {
    "change-selection.md",
    "add-a-table-or-figure.md",
    "add-a-claim.md",
    "ask-another-reading.md",
}
"""Pages that tests/test_how_to.py follows: with the changes that they show, or smaller runs."""
PLANNED_ONLY = {
    # these set up the environment, run all tests, wait for a person, or measure for long
    r"\bmake (environment|check|test|docs|lab|search|bench|lock)\b": r"make --dry-run \1",
    r"^snakemake (?=.*budget=(?:desk|paper|demo (?:reading|set)=))(?!.*--dry-run)": (
        "snakemake --dry-run "
    ),
    r"--profile profiles/slurm": "",
    r"--minutes \d+": "--minutes 0.1",
    r"--replay all": "--replay 1",
}
"""Replacements in commands of the documents, for those that take long."""


@dataclass(frozen=True)
class Block:
    """A code block of a page."""

    language: str
    title: str | None
    code: str

    @property
    def command(self) -> list[str]:
        """Command that runs the block."""
        if self.language == "python":
            return [sys.executable, "-c", self.code]
        code = self.code.replace("\\\n", " ")
        for long, short in PLANNED_ONLY.items():
            code = re.sub(long, short, code, flags=re.MULTILINE)
        return ["bash", "-eu", "-c", code]


def blocks(page: Path) -> list[Block]:
    """Return a page's code blocks; each names its language."""
    found = []
    for fence in FENCE.finditer(page.read_text(encoding="utf-8")):
        info = INFO.match(fence["info"].strip())
        assert info, f"{page.name}: ```{fence['info']} is no bash, python, yaml or text"
        found.append(Block(info["language"], info["title"], fence["code"]))
    return found


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A fresh clone that uses this environment as its own.

    Of what Table 1 shows, one task's records are missing.
    """
    clone = fresh_clone(tmp_path_factory.mktemp("documents") / "neol")
    environment = clone / ".venv"
    environment.mkdir()
    (environment / "bin").symlink_to(Path(sys.executable).parent)
    for stamp in (".environment", ".ready"):
        (environment / stamp).touch()
    make_records(clone, lambda job: job.part != "sensitivity" and job.spec.task.name != "cartpole")
    return clone


@pytest.mark.slow
@pytest.mark.parametrize(
    "page",
    [
        page
        for page in DOCUMENTS
        if page.name not in FOLLOWED and FENCE.search(page.read_text(encoding="utf-8"))
    ],
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_the_blocks_of_a_page_run(page: Path, clone: Path) -> None:
    environment = os.environ | {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(clone),
    }
    subprocess.run(["git", "clean", "-fdq"], cwd=clone, check=True)
    subprocess.run(["git", "checkout", "-q", "."], cwd=clone, check=True)
    for block in blocks(page):
        if block.title:
            (clone / block.title).write_text(block.code, encoding="utf-8")
        elif block.language in ("bash", "python"):
            ran = subprocess.run(
                block.command, cwd=clone, env=environment, capture_output=True, text=True
            )
            assert ran.returncode == 0, f"{block.code}\n{ran.stdout[-2000:]}\n{ran.stderr[-2000:]}"


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda page: str(page.relative_to(ROOT)))
def test_code_is_fenced(page: Path) -> None:
    """An indented block would escape these tests."""
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    assert not re.search(r"\n\n    \S", text)


def test_a_long_command_is_only_planned() -> None:
    long = Block("bash", None, "snakemake all --config budget=desk \\\n    --cores 8\nmake test\n")
    assert long.command[-1] == (
        "snakemake --dry-run all --config budget=desk      --cores 8\nmake --dry-run test\n"
    )
    changed = Block("bash", None, "snakemake tables --config budget=demo set=neat.elitism=1\n")
    assert changed.command[-1].startswith("snakemake --dry-run tables")
    shown = "snakemake tables --config budget=demo\n"
    assert Block("bash", None, shown).command[-1] == shown


def test_a_language_is_needed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("```\nls\n```\n")
    with pytest.raises(AssertionError, match="is no bash"):
        blocks(page)
