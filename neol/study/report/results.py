"""The page docs/results.md: how a budget's runs answer the paper's questions.

A budget other than the shown one has a page of its own, such as docs/results-demo.md.
`results.md.j2` is the text; `main_claims`, `in_short`, `levels` and `words` have the generated
sentences.
"""

from collections.abc import Hashable
from pathlib import Path
from typing import Any

import pandas as pd

from neol.base.files import write_atomically
from neol.pictures.labels import listed, task_label, three_figures
from neol.spec.configuration import PAPER_BUDGET, Configuration, load_configuration
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.cost import core_hours
from neol.study.campaign.grid import cells
from neol.study.campaign.shown import chosen_tasks, snakemake_options
from neol.study.claims.ledger import WHOLE, seeds_and_level
from neol.study.claims.plan import frozen_plan
from neol.study.claims.questions import load_claims, load_questions
from neol.study.claims.units import interval_in_print, unit_of
from neol.study.claims.verdicts import UNASKED
from neol.study.outcomes.campaign_runs import Campaign, costs
from neol.study.outcomes.contrasts import WHY_THEY_DIFFER
from neol.study.output.captions import (
    REDUCED,
    describe_budget,
    describe_name,
    describe_part,
    describe_size,
    describe_trials,
    is_papers,
    lacking,
)
from neol.study.report import words
from neol.study.report.common import command_line, render, verified, verified_frame, verified_table
from neol.study.report.further_runs import OPEN, costs_by_task
from neol.study.report.in_short import in_short, terms
from neol.study.report.levels import levels_reached
from neol.study.report.main_claims import about_the_table, answers_table, do_they_hold
from neol.study.report.speciation import crowded_cells, species_by_cell, species_by_task
from neol.study.tables.agreement import differing

COMPARED = {
    1: "final fitness against NEAT",
    7: "final fitness against NEAT (w/o)",
    2: "SCORE against NEAT",
    8: "SCORE against NEAT (w/o)",
}
"""Tables whose numbers stand beside the paper's."""
PICTURES = {"figure2": "", "beyond_effects": "-effects"}
"""Pictures beside the page, each with the end of its name."""


def page(campaign: Campaign, figures: Path, name: str) -> str:
    """The results as Markdown, for the file of this name; Figure 2 lies beside it.

    Raises UserError where a table is not there, or is not what its sidecar or the records say.
    """
    configuration = campaign.configuration
    shown = ["table1", "table2", "table7", *(f"numbers{number}" for number in COMPARED)]
    verified_tables = {name: verified_table(campaign, figures, name) for name in shown}
    tables = {name: table for name, (table, _) in verified_tables.items()}
    _, sidecar = verified_tables["table1"]
    ledger = verified_frame(figures / "claims.csv")
    effects = verified_frame(figures / "beyond_effects.csv")
    selection = verified_frame(figures / "beyond_selection.csv")
    species = species_by_cell(campaign)
    questions = answered(ledger)
    spent = costs(campaign)
    estimated = core_hours(configuration)
    papers = core_hours(load_configuration(PAPER_BUDGET, reading=configuration.reading))
    return render(
        "results.md.j2",
        name=name,
        options=snakemake_options(configuration),
        described=describe_budget(configuration),
        lacking=lacking(campaign),
        commit=sidecar.code(12),
        runs=spent["runs"]["all"],
        further_runs=_further_runs(campaign, figures / "claims.csv"),
        figures=figures.as_posix(),
        title=_title(configuration),
        do_they_hold=do_they_hold(ledger).markdown(),
        main_claims=answers_table(ledger),
        about_main_claims=about_the_table(ledger),
        in_short=[
            point.markdown() for point in in_short(campaign, species, ledger, effects, selection)
        ],
        levels=levels_reached(selection),
        against_neat=words.effects_table(effects, "neat"),
        against_ablation=words.effects_table(effects, "neat_wo"),
        after_correction=words.after_correction(effects),
        why_they_differ=WHY_THEY_DIFFER,
        terms=terms(ledger, effects),
        tables={name: table.markdown() for name, table in tables.items()},
        notes={name: table.notes for name, table in tables.items()},
        table_caption=tables["table1"].caption,
        agreements=[
            (number, outcome, differing(tables[f"numbers{number}"]))
            for number, outcome in COMPARED.items()
        ],
        answered=[row for row in questions if row["verdict"] not in UNASKED],
        open_questions=[row for row in questions if row["verdict"] == "too short"],
        not_asked=sum(row["verdict"] == "not asked here" for row in questions),
        plan=frozen_plan(),
        open_count=int(ledger.loc[ledger["part"] == WHOLE, "verdict"].isin(OPEN).sum()),
        cost_by_task=costs_by_task(campaign, ledger),
        papers_budget="nothing" if papers is None else three_figures(papers),
        estimated="nothing" if estimated is None else three_figures(estimated),
        spent=three_figures(spent["core_hours"]["all"]),
        trials=describe_trials(configuration),
        species=species_by_task(species),
        crowded=crowded_cells(species),
        kept=configuration.neat.places_kept,
        sensitivity=words.sensitive_constants(verified_frame(figures / "beyond_sensitivity.csv")),
    )


def _further_runs(campaign: Campaign, claims: Path) -> int:
    """Count the runs of other budgets that answers are made from: those of the two-by-two."""
    own = {source.path for source in campaign.sources(cells(campaign.configuration))}
    _, sidecar = verified(claims)
    return sum(len(record.runs) for record in sidecar.records if record.path not in own)


def _title(configuration: Configuration) -> str:
    """Return the page's title: no two budgets or readings have the same."""
    reading = configuration.reading
    return _of_budget(configuration) + (f", reading `{reading}`" * (reading != DEFAULT_READING))


def _of_budget(configuration: Configuration) -> str:
    budget = configuration.budget
    name = describe_name(budget)
    if is_papers(configuration):
        some = listed(map(task_label, chosen_tasks(budget)))
        return f"Results at the paper's budget{f': {some}' if some else ''}"
    reduced = [describe_size(configuration, task) == REDUCED for task in budget.tasks]
    parts = {describe_part(budget, task) for task in budget.tasks}
    if not any(reduced) and len(parts) == 1:
        every = listed(map(task_label, budget.tasks))
        return f"Results at a part of the paper's budget: {every}, {parts.pop()}"
    return f"Results at the {'reduced ' if all(reduced) else ''}budget `{name}`"


def answered(ledger: pd.DataFrame) -> list[dict[Hashable, Any]]:
    """Each question with its answer and the sentences of the paper that raise it."""
    asked = {question.id: question for question in load_questions()}
    claims = load_claims()
    rows = ledger[ledger["part"] == WHOLE].to_dict("records")
    for row in rows:
        question = asked[row["question"]]
        row |= {
            "ask": question.ask,
            "unit": unit_of(question) or "--",
            "ours": interval_in_print(question, row["effect"], row["low"], row["high"]),
            "papers": interval_in_print(
                question, row["paper_effect"], row["paper_low"], row["paper_high"]
            ),
            "fresh": interval_in_print(
                question, row["fresh_effect"], row["fresh_low"], row["fresh_high"]
            ),
            "seeds_and_level": seeds_and_level(row["seeds"], row["level"]),
            "quotes": [claim for claim in claims if question.id in claim.questions],
        }
    return rows


def write_page(campaign: Campaign, figures: Path, output: Path) -> None:
    """Write the page of a budget, with Figure 2 and the picture of effects beside it."""
    pictures = {name: verified(figures / f"{name}.png")[0] for name in PICTURES}
    write_atomically(output, page(campaign, figures, output.stem).encode())
    for name, picture in pictures.items():
        write_atomically(output.with_name(f"{output.stem}{PICTURES[name]}.png"), picture)


if __name__ == "__main__":
    command_line(
        "neol.study.report.results",
        __doc__,
        write_page,
        figures="the folder of its tables and figures",
        output="the page",
    )
