"""The page docs/results.md."""

import re
import shutil
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.study.claims.plan import plan_digest
from neol.study.claims.questions import load_questions
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.report.results import write_page


@pytest.fixture(scope="module")
def text(campaign: Campaign, figures: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("docs") / "results.md"
    write_page(campaign, figures, path)
    for name, copy in (("figure2", "results.png"), ("beyond_effects", "results-effects.png")):
        assert path.with_name(copy).read_bytes() == (figures / f"{name}.png").read_bytes()
    return path.read_text(encoding="utf-8")


def section(text: str, title: str) -> str:
    return text.split(f"\n## {title}\n")[1].split("\n## ")[0]


def test_only_questions_that_the_budget_asks_are_listed(text: str) -> None:
    asked = section(text, "The paper's questions")
    rows = [row for row in asked.splitlines() if row.startswith("| ")][2:]
    questions = load_questions()
    constructed = [each for each in questions if f"| {each.ask} | holds by construction" in asked]
    assert len(rows) == len(constructed) == 1
    assert f"Not asked here: {len(questions) - 1} of the questions" in asked
    assert (
        f"{len(questions) - 1} questions are open: too short, not asked here or inconclusive"
        in text
    )
    assert "answer 0. Not answered: 1 holds by construction." in section(text, "In short")
    assert plan_digest()[:16] in text


def test_tables_and_effects_are_there(text: str) -> None:
    assert re.search(r"\n\| in fresh episodes \| [-0-9.]+ \|", section(text, "Table 1"))
    compared = section(text, "Every comparison")
    assert "| held-out return | Hopper | 0.00 [0.00, 0.00]; 0.50 |" in compared


def test_the_papers_numbers_stand_beside_ours(text: str) -> None:
    beside = section(text, "The paper's numbers beside ours")
    for table in ("Table 1, final fitness against NEAT", "Table 8, SCORE against NEAT (w/o)"):
        assert f"\n{table}. Of 32 numbers, 16 means and " in beside
    assert "| Hopper, NEAT (w/o) | **7.00 ± 0.00** | 2296.57 ± 740.56 | -2290 [" in beside
    assert "| Hopper | 7 | 10 | 0 of 1,680 | 3" in section(text, "What more runs would cost")


def test_the_title_names_the_budget(text: str) -> None:
    assert text.startswith("# Results at the reduced budget `smoke`\n")


def test_tables_are_tables(text: str) -> None:
    """A blank line before, and as many cells in each line."""
    assert "<table>" not in text
    for table in re.findall(r"(?:^\|.*\n)+", text, re.M):
        assert f"\n\n{table}" in text
        assert len({line.count("|") for line in table.splitlines()}) == 1
        assert re.match(r"(\| --- )+\|$", table.splitlines()[1])
    assert "\n\n\n" not in text
    assert not re.search(r"\bnan\b|\bNone\b[^ ]|[{}]", text)


def test_an_edited_table_is_refused(campaign: Campaign, figures: Path, tmp_path: Path) -> None:
    shutil.copytree(figures, tmp_path / "figures")
    edited = tmp_path / "figures" / "beyond_effects.csv"
    edited.write_text(edited.read_text().replace("0.5", "0.9"))
    with pytest.raises(UserError, match=r"beyond_effects\.csv: changed since"):
        write_page(campaign, tmp_path / "figures", tmp_path / "results.md")
    assert not (tmp_path / "results.md").exists()
