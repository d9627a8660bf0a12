"""The report page: the claims, every table and figure, and what is behind them, in one HTML file.

It needs no network: style and pictures are inside. `page.html.j2` is its text.
"""

import argparse
import base64
import json
from collections import Counter
from collections.abc import Hashable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2
import markupsafe
import pandas as pd
from markdown_it import MarkdownIt

from neol.analysis import tables
from neol.analysis.captions import describe_budget, lacking
from neol.analysis.claims import Claim, load_claims
from neol.analysis.labels import HEATMAPS
from neol.analysis.runs import Campaign
from neol.campaign import RESULTS
from neol.errors import UserError
from neol.files import write_atomically
from neol.metadata import metadata
from neol.provenance import provenance
from neol.report.costs import costs
from neol.report.showcase import Showcase, Shown
from neol.spec import ROOT, load_configuration

CAPTIONS = ROOT / "paper" / "captions"
BEYOND = ("effects", "aggregates", "profiles", "efficiency", "selection", "sensitivity")


@dataclass(frozen=True, slots=True)
class Origin:
    """What made an output, as its sidecar has it."""

    command: str
    commit: str
    records: tuple[dict[str, Any], ...]

    @property
    def runs(self) -> int:
        return sum(len(record["runs"]) for record in self.records)


@dataclass(frozen=True, slots=True)
class Exhibit:
    """A table or a figure of the page."""

    name: str
    caption: str
    content: markupsafe.Markup
    origin: Origin


@dataclass(frozen=True, slots=True)
class Judged:
    """A claim with its parts, as claims.csv has them."""

    claim: Claim
    verdict: str
    parts: list[dict[Hashable, Any]]


def page(campaign: Campaign, figures: Path, champions: Path) -> str:
    """The report as HTML.

    `figures` holds the budget's tables and figures, `champions` what `showcase` made.
    Raises UserError where a file is not there.
    """
    configuration = campaign.configuration
    judged = _judged(figures)
    heatmaps = [
        number for number, (task, _) in HEATMAPS.items() if task in configuration.budget.tasks
    ]
    paper_tables = [_table(campaign, figures, number) for number in range(1, 9)]
    paper_figures = [_figure(figures, f"figure{number}") for number in (2, 3, *heatmaps)]
    beyond = [_figure(figures, f"beyond_{name}") for name in BEYOND]
    exhibits = [*paper_tables, *paper_figures, *beyond]
    records = {record["path"]: record for each in exhibits for record in each.origin.records}
    showcase = _read_showcase(champions)
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("neol.report", "."),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["short"] = lambda digest: digest[:12]
    return environment.get_template("page.html.j2").render(
        project=metadata(),
        budget=configuration.budget,
        described=describe_budget(configuration),
        lacking=lacking(campaign),
        made_by=provenance(),
        judged=judged,
        counts=Counter(each.verdict for each in judged),
        tables=paper_tables,
        figures=paper_figures,
        beyond=beyond,
        champions=[(shown, *_pictures(champions, shown)) for shown in showcase.champions],
        costs=costs(campaign),
        records=[records[path] for path in sorted(records)],
        assumptions=_markdown(ROOT / "docs" / "assumptions.md"),
    )


def _table(campaign: Campaign, figures: Path, number: int) -> Exhibit:
    name = f"table{number}"
    table = getattr(tables, name)(campaign)
    return Exhibit(
        name,
        _caption(name),
        markupsafe.Markup(table._repr_html_()),
        _origin(figures / f"{name}.json"),
    )


def _figure(figures: Path, name: str) -> Exhibit:
    caption = _caption(name)
    source = _data(figures / f"{name}.png", "image/png")
    image = markupsafe.Markup('<img src="{}" alt="{}">').format(source, caption)
    return Exhibit(name, caption, image, _origin(figures / f"{name}.json"))


def _caption(name: str) -> str:
    return (CAPTIONS / f"{name}.rst").read_text(encoding="utf-8").strip()


def _origin(path: Path) -> Origin:
    sidecar = json.loads(_bytes(path))
    return Origin(sidecar["command"], sidecar["commit"] or "unknown", tuple(sidecar["records"]))


def _judged(figures: Path) -> list[Judged]:
    claims = {claim.id: claim for claim in load_claims()}
    _bytes(figures / "claims.csv")
    parts = pd.read_csv(figures / "claims.csv")
    return [
        Judged(claims[str(name)], group["verdict"].iloc[0], group.to_dict("records"))
        for name, group in parts.groupby("claim", sort=False)
    ]


def _read_showcase(champions: Path) -> Showcase:
    return Showcase.model_validate_json(_bytes(champions / "champions.json"))


def _pictures(folder: Path, shown: Shown) -> tuple[str, str | None]:
    """The drawing of a champion's network, and its film where there is one."""
    network = _data(folder / f"{shown.task}.png", "image/png")
    filmed = shown.episode_return is not None
    return network, _data(folder / f"{shown.task}.gif", "image/gif") if filmed else None


def _markdown(path: Path) -> markupsafe.Markup:
    """A document without its title, its headings two levels lower."""
    text = path.read_text(encoding="utf-8").split("\n", 1)[1].replace("\n## ", "\n### ")
    return markupsafe.Markup(MarkdownIt("commonmark").enable("table").render(text))


def _data(path: Path, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(_bytes(path)).decode()}"


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise UserError(
            f"{path}: cannot be read ({error.strerror}); `make report` makes what the report needs"
        ) from None


def main() -> None:
    """Write the report of a budget."""
    parser = argparse.ArgumentParser(prog="python -m neol.report.page", description=__doc__)
    parser.add_argument("budget")
    parser.add_argument("figures", type=Path, help="the folder of its tables and figures")
    parser.add_argument("champions", type=Path, help="what neol.report.showcase made")
    parser.add_argument("output", type=Path)
    arguments = parser.parse_args()
    campaign = Campaign(load_configuration(arguments.budget), RESULTS)
    text = page(campaign, arguments.figures, arguments.champions)
    write_atomically(arguments.output, text.encode())


if __name__ == "__main__":
    main()
