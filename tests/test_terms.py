"""Pages explain a term where it first stands, and state no result that is not generated."""

import re
from pathlib import Path

import pytest

from neol.spec.configuration import ROOT
from neol.study.report.in_short import TERMS

EXPLAINED = {
    r"SCORE": r"SCORE is the paper's measure|SCORE \(.*best fitness summed over\s+generations\)",
    r"NEAT \(w/o\)": r"NEAT \(w/o\) is NEAT|NEAT\s+without\s+weight\s+mutation\s+\(NEAT \(w/o\)\)",
    r"\bchampions?\b": r"champion,? (is|a run's|of each run \()",
    r"\bheld-out\b": r"held-out\s+(episodes are|return\s+\()",
    r"†": r"† marks",
    r"\breadings?\b": r"can be read in several ways|readings? of\s+the\s+paper\s+\(",
    r"\bdigests?\b": r"digests?,? \(?(a hash|hashes)",
}
"""Terms of ours, each with a pattern of its explanation."""
PAGES = ["README.md", "docs/index.md", "docs/tutorial.md", "docs/readings.md"]
RESULTS = sorted(path.relative_to(ROOT) for path in ROOT.glob("docs/results*.md"))
NOT_PROSE = re.compile(r"```[\s\S]*?```|`[^`\n]*`|\[[^]]*\]\([^)]*\)|^#.*$|^!\[.*$", re.MULTILINE)
RESULT = re.compile(
    r"\d ?± ?\d|\bp [<=] 0|\d+ of \d+ (?:runs|questions|tests|comparisons)"
    r"|\b(?:[Rr]eproduced|[Ii]nconclusive|[Ee]quivalent to zero)\b:"
)
"""A number with its spread, a p-value, a count of outcomes, a verdict."""
BY_HAND = ["README.md", "docs/index.md", "docs/tutorial.md", "CONTRIBUTING.md"]


def _prose(page: str | Path) -> str:
    """Return a page without code, links and headings, the rest in its places."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return NOT_PROSE.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)


def unexplained(prose: str, terms: dict[str, str]) -> list[str]:
    """Return the terms that stand before their explanation, or have none."""
    found = []
    for term, explanation in terms.items():
        first, explained = re.search(term, prose), re.search(explanation, prose)
        if first and not (explained and explained.start() <= first.end()):
            found.append(f"{first.group()!r} in line {prose.count(chr(10), 0, first.start()) + 1}")
    return found


@pytest.mark.parametrize("page", [*PAGES, *RESULTS], ids=str)
def test_terms_are_explained_where_they_first_stand(page: str | Path) -> None:
    terms = {
        term: EXPLAINED[term] for term in EXPLAINED if page in PAGES or term != r"\breadings?\b"
    }
    assert unexplained(_prose(page), terms) == []


def test_a_term_before_its_explanation_is_found() -> None:
    terms = {"SCORE": EXPLAINED["SCORE"]}
    assert unexplained("SCORE grows. SCORE is the paper's measure of it.", terms) == [
        "'SCORE' in line 1"
    ]
    assert unexplained("SCORE is the paper's measure. SCORE grows.", terms) == []
    assert unexplained("\nOur SCORE.", terms) == ["'SCORE' in line 2"]


def test_the_readme_explains_terms_as_the_results_do() -> None:
    assert " ".join(TERMS) in " ".join((ROOT / "README.md").read_text().split())


@pytest.mark.parametrize("page", BY_HAND)
def test_a_result_in_a_page_is_one_that_was_generated(page: str) -> None:
    generated = "\n".join((ROOT / each).read_text(encoding="utf-8") for each in RESULTS)
    lines = _prose(page).splitlines()
    written = [line for line in lines if RESULT.search(line) and line not in generated]
    assert written == []


def test_results_written_by_hand_are_found() -> None:
    for line in ("312 ± 8", "p = 0.03", "3 of 24 tests", "Reproduced: two", "inconclusive: one"):
        assert RESULT.search(line), line
