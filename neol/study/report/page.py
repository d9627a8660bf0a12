"""The report page: the claims, every table and figure, and what is behind them, in one HTML file.

It needs no network: style and pictures are inside. `page.html.j2` is its text.
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
from neol.run.provenance import checkout, describe_checkout
from neol.run.record import campaign_name
from neol.spec.configuration import ROOT
from neol.study.campaign.shown import snakemake_options
from neol.study.claims.ledger import WHOLE
from neol.study.claims.plan import frozen_plan
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
from neol.study.report.results import answered
from neol.study.report.showcase import Showcase, Shown
from neol.study.workflow.exhibits import Exhibit, exhibits


@dataclass(frozen=True, slots=True)
class Displayed:
    """A table or figure as the page shows it."""

    exhibit: Exhibit
    content: markupsafe.Markup
    origin: Sidecar


def page(campaign: Campaign, figures: Path, champions: Path) -> str:
    """The report as HTML.

    `figures` holds the budget's tables and figures, `champions` is what `showcase` made.
    Raises UserError where a file is not there, or is not what its sidecar or the records say.
    """
    configuration = campaign.configuration
    questions = _answered(verified_frame(figures / "claims.csv"))
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
        questions=questions,
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
    return Displayed(exhibit, markupsafe.Markup(table._repr_html_()), sidecar)


def _figure(figures: Path, exhibit: Exhibit) -> Displayed:
    content, sidecar = verified(figures / f"{exhibit.name}.png")
    source = _data(content, "image/png")
    image = markupsafe.Markup('<img src="{}" alt="{}">').format(source, exhibit.caption)
    return Displayed(exhibit, image, sidecar)


def _answered(ledger: pd.DataFrame) -> list[dict[Hashable, Any]]:
    """Each question with its answer and its parts."""
    parts = ledger[ledger["part"] != WHOLE]
    return [
        row | {"parts": parts[parts["question"] == row["question"]].to_dict("records")}
        for row in answered(ledger)
    ]


def _pictures(shown: Shown) -> tuple[str, str | None]:
    """The drawing of a champion's network, and its film where there is one."""
    film = None if shown.film is None else _data(shown.film, "image/gif")
    return _data(shown.network, "image/png"), film


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
