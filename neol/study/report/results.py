"""The page docs/results.md: what a budget supports, contradicts and leaves open.

Another budget than the shown one has docs/results-paper-cartpole.md or the like. `results.md.j2`
is its text, `words` has its sentences.
"""

import math
from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from neol.base.files import write_atomically
from neol.pictures.labels import three_figures
from neol.study.campaign.shown import snakemake_options
from neol.study.claims import open_claims
from neol.study.claims.claims import load_claims
from neol.study.outcomes.campaign_runs import Campaign, costs
from neol.study.outcomes.contrasts import WHY_THEY_DIFFER
from neol.study.outcomes.movement import NEAR_CONTROL_WORDS
from neol.study.output.captions import describe_budget, describe_trials, lacking
from neol.study.report import words
from neol.study.report.common import command_line, render, verified, verified_frame, verified_table


def page(campaign: Campaign, figures: Path, name: str) -> str:
    """The results as Markdown, for the file of this name; Figure 2 lies beside it.

    Raises UserError where a table is not there, or is not what its sidecar or the records say.
    """
    configuration = campaign.configuration
    table, sidecar = verified_table(campaign, figures, "table1")
    ledger = verified_frame(figures / "claims.csv")
    effects = verified_frame(figures / "beyond_effects.csv")
    spent = costs(campaign)
    estimated = open_claims.core_hours(configuration, configuration.budget.seed_count)
    return render(
        "results.md.j2",
        name=name,
        options=snakemake_options(configuration),
        described=describe_budget(configuration),
        lacking=lacking(campaign),
        commit=sidecar.code(12),
        runs=spent["runs"]["all"],
        figures=figures.as_posix(),
        in_short=[*words.verdicts(ledger), *words.summary(effects)],
        against_neat=words.effects_table(effects, "neat"),
        against_ablation=words.effects_table(effects, "neat_wo"),
        after_correction=words.after_correction(effects),
        why_they_differ=WHY_THEY_DIFFER,
        near_control=NEAR_CONTROL_WORDS,
        flattered=words.flattered(verified_frame(figures / "beyond_selection.csv")),
        table=table._repr_html_(),
        judged=_judged(ledger),
        steps=open_claims.steps(ledger, configuration),
        estimated="nothing" if estimated is None else three_figures(estimated),
        spent=three_figures(spent["core_hours"]["all"]),
        trials=describe_trials(configuration),
        one_species=words.one_species(campaign),
        sensitivity=words.told_by_sensitivity(verified_frame(figures / "beyond_sensitivity.csv")),
    )


def _judged(ledger: pd.DataFrame) -> list[dict[Hashable, Any]]:
    """Each claim with the part that its verdict hangs on, and what an open one lacks."""
    claims = {claim.id: claim for claim in load_claims()}
    lacks = open_claims.lacks_of_open(ledger)
    rows = ledger[ledger["decisive"]].to_dict("records")
    for row in rows:
        name = row["claim"]
        row |= {"said": claims[name], "told": _effect(row), "lacks": lacks.get(name)}
    return rows


def _effect(row: Mapping[Any, Any]) -> str:
    if math.isnan(row["effect"]):
        return "--"
    effect, low, high = (three_figures(row[name]) for name in ("effect", "low", "high"))
    return f"{effect} [{low}, {high}] {row['unit']}"


def write_page(campaign: Campaign, figures: Path, output: Path) -> None:
    """Write the page of a budget, and Figure 2 beside it."""
    picture, _ = verified(figures / "figure2.png")
    write_atomically(output, page(campaign, figures, output.stem).encode())
    write_atomically(output.with_suffix(".png"), picture)


if __name__ == "__main__":
    command_line(
        "neol.study.report.results",
        __doc__,
        write_page,
        figures="the folder of its tables and figures",
        output="the page",
    )
