"""The numbers in the text of paper/reproduction.tex, each from a file made from records.

The text writes \\result{table1/hopper/bcm/here} for BCM on Hopper in Table 1, with `paper` at
its end for the paper's own value beneath it, and \\result{cost/hopper/runs} for costs. A
value that a budget does not have, such as one of a missing task, is printed as a dash.
"""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path

import pandas as pd

from neol.base.files import write_atomically
from neol.pictures.labels import listed, task_label
from neol.spec.configuration import Configuration
from neol.study.claims.ledger import WHOLE
from neol.study.claims.plan import frozen_plan
from neol.study.claims.questions import load_claims
from neol.study.outcomes import paper_numbers
from neol.study.outcomes.campaign_runs import Campaign, costs
from neol.study.outcomes.effects import FITNESS
from neol.study.output.captions import (
    describe_generations,
    describe_largest_population,
    describe_name,
    describe_populations,
    describe_reading,
    describe_samples,
    describe_seeds,
    describe_trials,
    is_papers,
    lacking,
)
from neol.study.output.latex import escape
from neol.study.report import words
from neol.study.report.citation import citation
from neol.study.report.common import command_line, verified_frame, verified_table
from neol.study.report.in_short import in_short
from neol.study.report.levels import levels_reached
from neol.study.report.main_claims import do_they_hold
from neol.study.report.speciation import crowded_cells, species_by_cell, species_by_task
from neol.study.tables.table import Table, latex_entry
from neol.study.workflow.exhibits import EXHIBITS, TABLES

TABLES_TOGETHER = {
    "fitness": ("table1", "table3", "table4", "table5", "table7"),
    "score": ("table2", "table6", "table8"),
}
"""Tables that each of the text's own tables puts together."""

_DEFINITIONS = r"""
\makeatletter
\newcommand{\setresult}[2]{\@namedef{result:#1}{#2}}
\newcommand{\result}[1]{\ifcsname result:#1\endcsname\@nameuse{result:#1}\else--\fi}
\makeatother
"""


def numbers(campaign: Campaign, figures: Path) -> dict[str, str]:
    """Return every number that the text may show, by name, as LaTeX.

    Raises UserError if a file is missing from the folder `figures`, or differs from its sidecar or
    the records.
    """
    found = dict(_of_configuration(campaign.configuration))
    found |= {f"caption/{each.name}": escape(each.caption) for each in EXHIBITS}
    found["budget/lacking"] = escape(lacking(campaign))
    found["budget/samples"] = escape(describe_samples(campaign))
    names = [each.name for each in EXHIBITS if each.group is TABLES]
    tables = {name: verified_table(campaign, figures, name)[0] for name in names}
    for table in tables.values():
        found |= dict(_printed(table))
    for name, together in TABLES_TOGETHER.items():
        found[f"{name}/notes"] = _notes([tables[each] for each in together])
    found |= dict(_of_costs(costs(campaign)))
    found |= _of_claims(verified_frame(figures / "claims.csv"))
    return found


def results_tex(campaign: Campaign, figures: Path) -> str:
    """Return the paper's input file: its numbers, and macros for sentences and names."""
    project = citation()
    configuration = campaign.configuration
    texts = {
        "figures": figures.as_posix(),
        "projecttitle": escape(project["title"]),
        "projectauthors": escape(", ".join(author["name"] for author in project["authors"])),
        "projectversion": escape(project["version"]),
        "papertitle": escape(project["references"][0]["title"]),
        "contradictions": _items(
            f"Table {table}: {text}"
            for table, sentences in paper_numbers.CONTRADICTIONS.items()
            for text in sentences
        ),
        **_in_words(campaign, figures),
    }
    each_task = "".join(f"#1{{{task}}}" for task in configuration.budget.tasks)
    lines = [
        "% Written by `python -m neol.study.report.paper_text`.",
        _DEFINITIONS.strip(),
        *(rf"\newcommand{{\{name}}}{{{text}}}" for name, text in texts.items()),
        rf"\newcommand{{\foreachtask}}[1]{{{each_task}}}",
        *(rf"\setresult{{{name}}}{{{text}}}" for name, text in numbers(campaign, figures).items()),
    ]
    return "\n".join(lines) + "\n"


def _in_words(campaign: Campaign, figures: Path) -> dict[str, str]:
    """Return the sentences that docs/results.md also has."""
    configuration = campaign.configuration
    effects = verified_frame(figures / "beyond_effects.csv")
    sensitivity = verified_frame(figures / "beyond_sensitivity.csv")
    selection = verified_frame(figures / "beyond_selection.csv")
    ledger = verified_frame(figures / "claims.csv")
    species = species_by_cell(campaign)
    points = in_short(campaign, species, ledger, effects, selection)
    return {
        "differences": _items(words.differences(effects, FITNESS, "neat")),
        "differencesablation": _items(words.differences(effects, FITNESS, "neat_wo")),
        "inshort": "".join(
            rf"\item \textbf{{{escape(point.lead)}}} {escape(point.text.replace('`', ''))} "
            for point in (do_they_hold(ledger), *points)
        ),
        "aftercorrection": escape(words.after_correction(effects)),
        "selectionbias": _items(levels_reached(selection)),
        "plan": escape(frozen_plan().replace("`", "")),
        "sensitiveconstants": _items(words.sensitive_constants(sensitivity)),
        "trials": escape(describe_trials(configuration)),
        "species": _items(species_by_task(species)),
        "crowded": escape(crowded_cells(species) or "none"),
    }


def _items(sentences: Iterable[str]) -> str:
    return "".join(rf"\item {escape(sentence)} " for sentence in sentences)


def _of_configuration(configuration: Configuration) -> Iterator[tuple[str, str]]:
    budget = configuration.budget
    reduced = "" if is_papers(configuration) else r"\emph{This is less than the paper's budget.}"
    yield "budget/name", escape(describe_name(budget))
    yield "budget/generations", escape(describe_generations(budget))
    yield "budget/seeds", escape(describe_seeds(budget))
    yield "budget/largest_population", escape(describe_largest_population(budget))
    yield "budget/populations", escape(describe_populations(budget))
    yield "budget/learning_rates", ", ".join(map(_number, budget.learning_rates))
    yield "budget/reduced", reduced
    yield "budget/reading", escape(describe_reading(configuration))
    yield "spec/episodes", _number(configuration.evaluation.episodes)
    yield "spec/held_out_episodes", _number(configuration.evaluation.held_out_episodes)
    yield "spec/reward_scale", _number(configuration.plasticity.reward_scale)
    for name, task in configuration.tasks.items():
        yield f"tasks/{name}/label", escape(task_label(name))
        yield f"tasks/{name}/max_steps", _number(task.max_steps)


def _printed(table: Table) -> Iterator[tuple[str, str]]:
    """Yield each entry as the table prints it, and the paper's beneath it."""
    rows = table.frame.groupby("task", sort=False)["method"]
    ours = [line for line in table.lines if not line.is_beneath]
    papers = [line for line in table.lines if line.label == "paper"]
    for (task, methods), own, paper_line in zip(rows, ours, papers, strict=True):
        for method, here, paper in zip(methods, own.entries, paper_line.entries, strict=True):
            yield f"{table.name}/{task}/{method}/here", latex_entry(here)
            yield f"{table.name}/{task}/{method}/paper", latex_entry(paper)


def _notes(tables: Iterable[Table]) -> str:
    """Return the notes of these tables, each once, without contradictions of the paper."""
    whose: dict[str, list[str]] = {}
    for table in tables:
        for note in table.notes:
            if note not in paper_numbers.CONTRADICTIONS.get(int(table.number), ()):
                whose.setdefault(note, []).append(str(table.number))
    return " ".join(
        escape(f"Table{'s' * (len(numbers) > 1)} {', '.join(numbers)}: {note}")
        for note, numbers in whose.items()
    )


def _of_costs(spent: pd.DataFrame) -> Iterator[tuple[str, str]]:
    for task, row in spent.iterrows():
        for name, value in row.items():
            yield f"cost/{task}/{name}", _number(float(value))


def _of_claims(parts: pd.DataFrame) -> dict[str, str]:
    whole = parts[parts["part"] == WHOLE]
    counts = whole["verdict"].value_counts()
    return {
        "claims/count/all": str(len(whole)),
        "claims/quotes": str(len(load_claims())),
        "claims/counted": listed(f"{count} {verdict}" for verdict, count in counts.items()),
        **dict(zip("claims/" + whole["question"] + "/verdict", whole["verdict"], strict=True)),
    }


def _number(value: float) -> str:
    """Format whole numbers in full, others with four significant digits, as LaTeX."""
    if math.isnan(value):
        return "--"
    if math.isinf(value):
        return r"$\infty$"
    if value == int(value) and abs(value) < 1e15:
        return f"{int(value):,}".replace(",", r"\,").replace("-", "$-$")
    mantissa, _, exponent = f"{value:.4g}".partition("e")
    if exponent:
        return rf"${mantissa}\times 10^{{{int(exponent)}}}$"
    return mantissa.replace("-", "$-$")


def write_results_tex(campaign: Campaign, figures: Path, output: Path) -> None:
    """Write the numbers of a budget."""
    output.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(output, results_tex(campaign, figures).encode())


if __name__ == "__main__":
    command_line(
        "neol.study.report.paper_text",
        __doc__,
        write_results_tex,
        figures="the folder of the budget's tables",
        output="the file that the paper inputs",
    )
