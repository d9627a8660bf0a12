"""The page docs/results.md: what a budget supports, contradicts and leaves open.

`results.md.j2` is its text, `words` has its sentences.
"""

import math
from collections import Counter
from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import Any

import jinja2
import pandas as pd

from neol.analysis.captions import describe_budget, lacking
from neol.analysis.claims import load_claims
from neol.analysis.labels import three_figures
from neol.analysis.runs import Campaign
from neol.files import write_atomically
from neol.report import words
from neol.report.costs import costs
from neol.report.inputs import command_line, vouched, vouched_frame, vouched_table
from neol.selection import snakemake_options


def page(campaign: Campaign, figures: Path, picture: str) -> str:
    """The results as Markdown; `picture` is the path of Figure 2 from there.

    Raises UserError where a table is not there, or is not what its sidecar or the records say.
    """
    configuration = campaign.configuration
    table, sidecar = vouched_table(campaign, figures, 1)
    ledger = vouched_frame(figures / "claims.csv")
    effects = vouched_frame(figures / "beyond_effects.csv")
    spent = costs(campaign)
    estimated = words.core_hours(configuration, configuration.budget.seeds)
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("neol.report", "."),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template("results.md.j2").render(
        options=snakemake_options(configuration.budget),
        described=describe_budget(configuration),
        lacking=lacking(campaign),
        commit=sidecar.commit,
        runs=spent["runs"]["all"],
        figures=figures.as_posix(),
        counts=Counter(
            {"supported": 0, "contradicted": 0, "undecided": 0},
            **Counter(ledger.groupby("claim")["verdict"].first()),
        ),
        against_neat=words.told_apart(effects, words.FITNESS),
        ablation=words.told_apart(effects, words.ABLATION),
        after_correction=words.after_correction(effects),
        flattered=words.flattered(vouched_frame(figures / "beyond_selection.csv")),
        table=table._repr_html_(),
        picture=picture,
        judged=_judged(ledger),
        steps=words.steps(ledger, configuration),
        estimated="nothing" if estimated is None else three_figures(estimated),
        spent=three_figures(spent["core_hours"]["all"]),
        sensitivity=words.told_by_sensitivity(vouched_frame(figures / "beyond_sensitivity.csv")),
    )


def _judged(ledger: pd.DataFrame) -> list[dict[Hashable, Any]]:
    """Each claim with the part that its verdict hangs on, and what an open one lacks."""
    quotes = {claim.id: claim.quote for claim in load_claims()}
    lacks = words.lacks_of_open(ledger)
    rows = ledger[ledger["decisive"]].to_dict("records")
    for row in rows:
        name = row["claim"]
        row |= {"quote": quotes[name], "told": _effect(row), "lacks": lacks.get(name)}
    return rows


def _effect(row: Mapping[Any, Any]) -> str:
    if math.isnan(row["effect"]):
        return "--"
    effect, low, high = (three_figures(row[name]) for name in ("effect", "low", "high"))
    return f"{effect} [{low}, {high}] {row['unit']}"


def write_page(campaign: Campaign, figures: Path, output: Path) -> None:
    """Write the page of a budget, and Figure 2 beside it."""
    picture, _ = vouched(figures / "figure2.png")
    write_atomically(output, page(campaign, figures, output.with_suffix(".png").name).encode())
    write_atomically(output.with_suffix(".png"), picture)


if __name__ == "__main__":
    command_line(
        "neol.report.results",
        __doc__,
        write_page,
        figures="the folder of its tables and figures",
        output="the page",
    )
