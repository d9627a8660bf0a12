"""Documents name only existing functions, files and constants."""

import importlib
import re
import runpy
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT, budgets, load_configuration
from neol.study.campaign.grid import RESULTS, blocks, cells
from neol.study.campaign.shown import select
from neol.study.output.captions import (
    describe_generations,
    describe_populations,
    describe_seeds,
)
from neol.study.report.readme import README, RESULTS_PAGE, with_parts

DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
CODE_SPAN = re.compile(r"`([^`\n]+)`")
FUNCTION = re.compile(r"neol(?:\.\w+)+$")
CONSTANT = re.compile(r"(?:network|plasticity|evaluation|neat)\.(?!py$)\w+$")
LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)")


def code_spans(path: Path) -> list[str]:
    return CODE_SPAN.findall(path.read_text(encoding="utf-8"))


def resolve(name: str) -> object:
    """Return the object of a dotted name such as neol.neat.genome.Genome.copy."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        try:
            found: object = importlib.import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[length:]:
            found = getattr(found, attribute)
        return found
    raise ModuleNotFoundError(name)


def test_algorithm_names_functions() -> None:
    named = [span for span in code_spans(ROOT / "docs" / "algorithm.md") if FUNCTION.match(span)]
    assert len(named) > 40


def test_a_function_that_is_not_there_is_found_out() -> None:
    with pytest.raises(AttributeError):
        resolve("neol.neat.variation.mutate_everything")


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.stem)
def test_every_function_named_exists(path: Path) -> None:
    for span in code_spans(path):
        if FUNCTION.match(span):
            resolve(span)


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.stem)
def test_every_constant_named_exists(path: Path) -> None:
    constants = load_configuration("paper").model_dump()
    for span in code_spans(path):
        if CONSTANT.match(span):
            section, key = span.split(".")
            assert key in constants[section], span


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.stem)
def test_every_link_leads_somewhere(path: Path) -> None:
    for target in LINK.findall(path.read_text(encoding="utf-8")):
        assert (path.parent / target).exists(), target


@pytest.mark.slow
def test_the_page_of_the_command_line_lists_whole_summaries() -> None:
    page = runpy.run_path(str(ROOT / "docs" / "hooks.py"))["command_line"]()
    assert page.startswith("# Command line\n")
    for name, summary in re.findall(r"^\* `(\w+)`: (.*)$", page, re.MULTILINE):
        assert f"\n## `neol {name}`\n\n{summary}\n" in page


def test_the_readme_knows_the_budgets_and_their_records() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    records = set()
    for name in budgets():
        configuration = select(name)
        budget = configuration.budget
        runs = sum(len(budget.seeds_of(cell.task)) for cell in cells(configuration))
        assert (
            f"| `{name}` | {describe_generations(budget)} | {describe_seeds(budget)} "
            f"| {describe_populations(budget)} "
            f"| {len(budget.learning_rates)} | {runs:,} |"
        ) in text
        records |= {str(RESULTS / block.record) for block in blocks(configuration)}
    assert set(re.findall(r"results/\S+\.parquet", text)) <= records


def test_the_readme_shows_the_results_as_they_were_written() -> None:
    readme, results = (path.read_text(encoding="utf-8") for path in (README, RESULTS_PAGE))
    assert readme == with_parts(readme, results), "run: python -m neol.study.report.readme"


def test_a_text_without_markers_is_refused() -> None:
    with pytest.raises(AssertionError, match=r"answer of docs/results\.md: begin"):
        with_parts("no markers here", RESULTS_PAGE.read_text(encoding="utf-8"))
