"""The report page: the questions, every table and figure, and their sources, in one HTML file.

It needs no network: style and pictures are inside. Links lead to figures in full size, which lie
beside it. `page.html.j2` is its text.
"""

import base64
import re
from collections import Counter
from collections.abc import Hashable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import markupsafe
import pandas as pd
from markdown_it import MarkdownIt

from neol.base.files import write_atomically
from neol.pictures.labels import METHOD_LABELS, TASK_LABELS
from neol.run.provenance import checkout, describe_checkout
from neol.run.record import campaign_name
from neol.spec.configuration import ROOT
from neol.study.campaign.shown import snakemake_options
from neol.study.claims.ledger import WHOLE
from neol.study.claims.plan import frozen_plan
from neol.study.claims.questions import load_questions
from neol.study.claims.units import in_print
from neol.study.claims.verdicts import UNASKED
from neol.study.outcomes.campaign_runs import Campaign, costs
from neol.study.output.captions import describe_budget, lacking
from neol.study.output.sidecar import INPUTS, Sidecar
from neol.study.report.citation import citation
from neol.study.report.common import (
    command_line,
    read,
    render,
    verified,
    verified_frame,
    verified_table,
)
from neol.study.report.embedding import short_gif, small_png
from neol.study.report.in_short import in_short, terms
from neol.study.report.levels import levels_reached
from neol.study.report.main_claims import about_the_table, answers_table, do_they_hold
from neol.study.report.results import answered
from neol.study.report.showcase import Showcase, Shown
from neol.study.report.speciation import species_by_cell
from neol.study.workflow.exhibits import Exhibit, exhibits

NAMES = TASK_LABELS | METHOD_LABELS
"""What readers call tasks and methods."""


@dataclass(frozen=True, slots=True)
class Displayed:
    """A table or figure as the page shows it."""

    exhibit: Exhibit
    content: markupsafe.Markup
    origin: Sidecar
    caption: str = ""
    """A table's own caption, which stays in view when the table is scrolled."""
    full_size: str = ""
    """Name of a figure's file beside the page."""


def page(campaign: Campaign, figures: Path, champions: Path) -> str:
    """The report as HTML.

    `figures` holds the budget's tables and figures, `champions` is what `showcase` made.
    Raises UserError where a file is not there, or is not what its sidecar or the records say.
    """
    configuration = campaign.configuration
    ledger = verified_frame(figures / "claims.csv")
    effects = verified_frame(figures / "beyond_effects.csv")
    selection = verified_frame(figures / "beyond_selection.csv")
    questions = _answered(ledger)
    budget = configuration.budget
    tables = [_table(campaign, figures, each) for each in exhibits(budget, "tables", "numbers")]
    paper_figures = [_figure(figures, each) for each in exhibits(budget, "figures")]
    beyond = [_figure(figures, each) for each in exhibits(budget, "beyond")]
    displayed = [*tables, *paper_figures, *beyond]
    records = {record.path: record for each in displayed for record in each.origin.records}
    showcase = Showcase.model_validate_json(read(champions))
    return render(
        "page.html.j2",
        project=citation(),
        budget=budget,
        campaign=campaign_name(configuration.reading, budget.name),
        options=snakemake_options(configuration),
        described=describe_budget(configuration),
        lacking=lacking(campaign),
        commit=describe_checkout(*checkout(*INPUTS, "docs/assumptions.md"), 12),
        do_they_hold=do_they_hold(ledger),
        main_claims=answers_table(ledger),
        about_main_claims=about_the_table(ledger),
        terms=terms(ledger, effects),
        in_short=in_short(campaign, species_by_cell(campaign), ledger, effects, selection),
        levels=levels_reached(selection),
        questions=questions,
        decided=[each for each in questions if each["verdict"] not in UNASKED],
        open_questions={
            verdict: [each for each in questions if each["verdict"] == verdict]
            for verdict in UNASKED
        },
        counts=Counter(each["verdict"] for each in questions),
        plan=frozen_plan(),
        tables=tables,
        figures=paper_figures,
        beyond=beyond,
        champions=[(shown, *_pictures(shown)) for shown in showcase.champions],
        costs=costs(campaign),
        records=[records[path] for path in sorted(records)],
        assumptions=_markdown(ROOT / "docs" / "assumptions.md"),
    )


def _table(campaign: Campaign, figures: Path, exhibit: Exhibit) -> Displayed:
    table, sidecar = verified_table(campaign, figures, exhibit.name)
    content = markupsafe.Markup(table.html_table())
    return Displayed(exhibit, content, sidecar, caption=table.caption)


def _figure(figures: Path, exhibit: Exhibit) -> Displayed:
    content, sidecar = verified(figures / f"{exhibit.name}.png")
    source = _data(small_png(content), "image/png")
    image = markupsafe.Markup('<img src="{}" alt="{}">').format(source, exhibit.caption)
    return Displayed(exhibit, image, sidecar, full_size=f"{exhibit.name}.png")


def _answered(ledger: pd.DataFrame) -> list[dict[Hashable, Any]]:
    """Return each question with its answer, its unit and its parts by their labels."""
    parts = ledger[ledger["part"] != WHOLE]
    parts = parts.assign(part=parts["part"].map(_readable))
    for question in load_questions():
        here = parts["question"] == question.id
        for column in ("effect", "low", "high", "paper_effect"):
            parts.loc[here, column] = in_print(question, *parts.loc[here, column])
    return [
        row | {"parts": parts[parts["question"] == row["question"]].to_dict("records")}
        for row in answered(ledger)
    ]


def _readable(label: str) -> str:
    """Return a part's label with the names that readers know: "Hopper: BCM"."""
    return re.sub(r"[a-z_]+", lambda word: NAMES.get(word[0], word[0]), label)


def _pictures(shown: Shown) -> tuple[str, str | None]:
    """The drawing of a champion's network, and its film where there is one."""
    film = None if shown.film is None else _data(short_gif(shown.film), "image/gif")
    return _data(small_png(shown.network), "image/png"), film


def _markdown(path: Path) -> markupsafe.Markup:
    """A document without its title and its links to other pages, its headings lower."""
    text = path.read_text(encoding="utf-8").split("\n", 1)[1].replace("\n## ", "\n### ")
    text = re.sub(r"\[([^\]]*)\]\((?![#:]|https?:)[^)]*\)", r"\1", text)  # the page is one file
    return markupsafe.Markup(MarkdownIt("commonmark").enable("table").render(text))


def _data(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def write_page(campaign: Campaign, figures: Path, champions: Path, output: Path) -> None:
    """Write the report of a budget."""
    write_atomically(output, page(campaign, figures, champions).encode())


if __name__ == "__main__":
    command_line(
        "neol.study.report.page",
        __doc__,
        write_page,
        figures="the folder of its tables and figures",
        champions="what neol.study.report.showcase made",
        output="the page",
    )
