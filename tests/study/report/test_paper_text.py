"""The paper's text: its numbers come from tables, and none is typed."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from neol.base.errors import UserError
from neol.pictures.labels import TASK_LABELS
from neol.spec.configuration import ROOT
from neol.study.campaign.grid import cells
from neol.study.claims.questions import load_questions
from neol.study.outcomes.campaign_runs import Campaign, costs
from neol.study.outcomes.paper_numbers import CONTRADICTIONS
from neol.study.report.paper_text import _notes, _number, numbers, results_tex
from neol.study.tables import paper_tables

TEXT = (ROOT / "paper" / "reproduction.tex").read_text(encoding="utf-8")


def names() -> set[str]:
    """Every name that the text gives to \\result, for each of the tasks."""
    text = TEXT
    for place, whose in re.findall(r"\\rules{(table.+?)}{(.+?)}", TEXT):
        text += "".join(rf"\result{{{place}/{rule}/{whose}}}" for rule in ("bcm", "hebb", "oja"))
    for drawn in re.findall(r"\\drawing(?:\[.*?\])?{(.+?)}", TEXT):
        text += rf"\result{{caption/{drawn}}}"
    found = re.findall(r"\\result{([^}]*)}", " ".join(text.split()))
    return {
        name.replace("#1", task)
        for name in found
        for task in TASK_LABELS
        if not re.search(r"#2|^#1/", name)
    }


def test_every_number_that_the_text_names_is_there(campaign: Campaign, figures: Path) -> None:
    there = numbers(campaign, figures)
    assert len(names()) > 50
    assert sorted(names() - there.keys()) == []


def test_entries_are_as_the_tables_print_them(campaign: Campaign, figures: Path) -> None:
    there = numbers(campaign, figures)
    assert there["table1/hopper/bcm/here"] == r"\textbf{7.00 $\pm$ 0.00}"
    assert there["table1/hopper/bcm/paper"] == r"\textbf{2983.82 $\pm$ 479.79}"
    assert there["table5/hopper/hebb/paper"] == "5.746e$-$2"


def test_notes_stand_once_and_contradictions_elsewhere(campaign: Campaign) -> None:
    first = replace(paper_tables.table1(campaign), notes=("(a) 2 seeds.", *CONTRADICTIONS[1]))
    second = replace(paper_tables.table7(campaign), notes=("(a) 2 seeds.", "(b) No run."))
    assert _notes([first, second]) == "Tables 1, 7: (a) 2 seeds. Table 7: (b) No run."


def test_costs_add_up(campaign: Campaign) -> None:
    spent = costs(campaign)
    runs = len(cells(campaign.configuration)) * campaign.configuration.budget.seeds
    assert spent.loc["all", "runs"] == runs
    assert spent.loc["hopper", "runs"] == runs / 4
    assert list(spent.index) == [*TASK_LABELS, "all"]
    by_hand = sum(
        cell.population * campaign.configuration.budget.generations_of("hopper")
        for cell in cells(campaign.configuration)
        if cell.task == "hopper"
    )
    assert spent.loc["hopper", "evaluations"] == by_hand * campaign.configuration.budget.seeds


def test_verdicts_are_counted_by_question(campaign: Campaign, figures: Path) -> None:
    there = numbers(campaign, figures)
    assert there["claims/count/all"] == str(len(load_questions()))
    assert there["claims/counted"] == "35 not asked here and 1 holds by construction"
    assert there["claims/cartpole-ceiling/verdict"] == "not asked here"


def test_a_missing_table_is_said(campaign: Campaign, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"table1\.csv: cannot be read .*make report"):
        numbers(campaign, tmp_path)


@pytest.mark.parametrize("edited", ["table1.csv", "table7.tex", "claims.csv"])
def test_an_edited_file_is_refused(
    campaign: Campaign, figures: Path, tmp_path: Path, edited: str
) -> None:
    shutil.copytree(figures, tmp_path, dirs_exist_ok=True)
    file = tmp_path / edited
    file.write_text(file.read_text().replace("7", "8").replace("not asked", "asked"))
    with pytest.raises(UserError, match=rf"{edited}: changed since {file.stem}\.json was written"):
        numbers(campaign, tmp_path)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (500.0, "500"),
        (6240, r"6\,240"),
        (-83, "$-$83"),
        (0.0378307, "0.03783"),
        (-1.25, "$-$1.25"),
        (1.202e-8, r"$1.202\times 10^{-8}$"),
        (np.nan, "--"),
        (np.inf, r"$\infty$"),
        (0.0, "0"),
    ],
)
def test_numbers_as_latex(value: float, text: str) -> None:
    assert _number(value) == text


def test_text_has_no_typed_number() -> None:
    """Digits stand only in formulas, names, references to the paper's parts, the bibliography."""
    assert typed_numbers(TEXT) == []


def test_a_typed_number_is_found() -> None:
    assert typed_numbers(r"\begin{document} BCM reaches 324.3 on Hopper. \end{document}") == [
        "324.3"
    ]


def typed_numbers(text: str) -> list[str]:
    body = text[text.index(r"\begin{document}") :]
    for exempt in (
        r"(?s)\\begin{thebibliography}.*",
        r"(?m)(?<!\\)%.*$",
        r"(?s)\\begin{equation\*}.*?\\end{equation\*}",
        r"\$[^$]*\$",
        r"(?s)\\(?:result|input|label|ref|cite|drawing|rules|begin|end|newcommand)(?:\[[^]]*\]|{[^{}]*})+",
        r"(?:Tables?|Figures?|Sections?|Algorithms?|Equations?)[ ~]"
        r"(?:\d+(?:\.\d+)?(?:, | and | to )?)+",
        r"figures/table\d",
        r"#\d",
        r"\\texttt{[^}]*}",
    ):
        body = re.sub(exempt, " ", body)
    return re.findall(r"\d[\d.,]*", body)


def test_macros_are_there(campaign: Campaign, figures: Path) -> None:
    text = results_tex(campaign, figures)
    for macro in ("figures", "projecttitle", "papertitle", "foreachtask", "contradictions"):
        assert rf"\newcommand{{\{macro}}}" in text
    for sentences in ("differences", "differencesablation", "selectionbias", "sensitiveconstants"):
        assert rf"\newcommand{{\{sentences}}}{{\item " in text
