"""What the results say in words, for the page docs/results.md and for the paper.

Every sentence is made of cells of a budget's tables and says no more than the interval beside it: a
comparison whose interval holds "no difference" is not distinguishable.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from neol.pictures.labels import listed, method_label, task_label, three_figures
from neol.study.campaign.grid import cells
from neol.study.campaign.methods import shown_methods
from neol.study.campaign.variants import BASELINE, variants
from neol.study.claims.ledger import WHOLE
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.effects import OUTCOMES
from neol.study.outcomes.movement import NEAR_CONTROL_MARK, NEAR_CONTROL_WORDS
from neol.study.outcomes.statistics import ALPHA

DECIDED = ("reproduced", "same direction", "mixed", "not reproduced", "equivalent to zero")
"""Verdicts that are answers."""


def verdicts(ledger: pd.DataFrame) -> list[str]:
    """How many questions have which verdict, and which are decided."""
    whole = ledger[ledger["part"] == WHOLE]
    counts = whole["verdict"].value_counts(sort=False)
    listed_counts = listed(f"{count} {verdict}" for verdict, count in counts.items())
    sentences = [f"The paper's claims come down to {len(whole)} questions: {listed_counts}."]
    for verdict in DECIDED:
        names = whole.loc[whole["verdict"] == verdict, "question"]
        if len(names):
            named = listed(f"`{name}`" for name in names)
            sentences.append(f"{verdict.capitalize()}: {named}.")
    return sentences


def summary(effects: pd.DataFrame) -> list[str]:
    """Which methods are distinguishable from NEAT, and from NEAT (w/o), by which outcome.

    A rule that moves next to nothing is named apart: it is a control.
    """
    learned = effects[~effects["near_control"].eq(True)]

    def told(some: pd.DataFrame, against: str) -> str:
        return "; ".join(
            f"in {outcome}, {_apart(some, outcome, against) or 'none'}" for outcome in OUTCOMES
        )

    sentences = [
        "Distinguishable from NEAT (the 95% interval of the difference of means excludes 0): "
        f"{told(learned, 'neat')}.",
        "Distinguishable from NEAT (w/o), which neither learns nor mutates weights: "
        f"{told(learned, 'neat_wo')}.",
        "An advantage that NEAT without weight mutation shares cannot come from learning.",
    ]
    little = effects[effects["near_control"].eq(True)]
    if any(_apart(little, outcome, "neat") for outcome in OUTCOMES):
        sentences.append(
            f"No success of a rule, because it is {NEAR_CONTROL_WORDS}: {told(little, 'neat')} "
            "(against NEAT)."
        )
    return sentences


def told_apart(effects: pd.DataFrame, outcome: str, against: str) -> list[str]:
    """For each task which methods end higher or lower than another one, and by how much."""
    sentences = []
    compared = _comparison(effects, outcome, against)
    for task, rows in compared[compared["task"] != "all"].groupby("task", sort=False):
        sides: dict[str, list[str]] = {}
        for row in rows.to_dict("records"):
            gap = f" {_difference(row)}" if row["seeds"] else ""
            sides.setdefault(_side(row), []).append(f"{method_label(row['method'])}{gap}")
        other = method_label(against)
        said = "; ".join(f"{', '.join(some)} {side} {other}" for side, some in sides.items())
        sentences.append(f"{task_label(str(task))}: {said}.")
    return sentences


def effects_table(effects: pd.DataFrame, against: str) -> list[list[str]]:
    """Differences from a method: a head, then a row for each outcome and task.

    Each with its interval and A12; bold is distinguishable, unless the rule is near control.
    """
    here = effects[(effects["against"] == against) & (effects["task"] != "all")]
    methods = list(dict.fromkeys(here["method"]))
    rows = [["outcome", "task", *map(method_label, methods)]]
    for (outcome, task), some in here.groupby(["outcome", "task"], sort=False):
        by_method = {row["method"]: row for row in some.to_dict("records")}
        entries = [_entry(by_method[method]) for method in methods]
        rows.append([str(outcome), task_label(str(task)), *entries])
    return rows


def after_correction(effects: pd.DataFrame) -> str:
    """How many of the declared tests remain significant."""
    tested = effects.dropna(subset="p_holm")
    significant = tested[tested["p_holm"] < ALPHA]
    named = "; ".join(
        f"{row['outcome']}, {task_label(row['task'])}, {_name(row)} against "
        f"{method_label(row['against'])}"
        for row in significant.to_dict("records")
    )
    return (
        f"Of {len(tested)} tests of the declared family (Welch's, two-sided), {len(significant)} "
        f"have p < {ALPHA} after Holm's correction{f': {named}' if named else ''}."
    )


def flattered(selection: pd.DataFrame) -> list[str]:
    """For each task what champions get again, and how far their training maxima lie above it."""
    sentences = []
    for task, rows in selection.dropna(subset="mean").groupby("task", sort=False):
        again, above = (_range(rows[name]) for name in ("held_out", "mean"))
        sentences.append(f"{task_label(str(task))}: {again} again, {above} less than in training.")
    return sentences


def told_by_sensitivity(table: pd.DataFrame) -> list[str]:
    """For each task which readings of the paper were told apart from the baseline's, and how."""
    varied = table[(table["variant"] != BASELINE) & (table["pairs"] > 0)]
    if varied.empty:
        return ["None of the study's runs is there."]
    idle = varied["same"] == varied["seeds"]
    tried = varied[~idle]
    differ = tried[(tried["low"] > 0.5) | (tried["high"] < 0.5)]
    constants = {name: ", ".join(variant.set) for name, variant in variants().items()}
    sentences = []
    for task in dict.fromkeys(varied["task"]):
        named = ", ".join(
            f"{constants[row['variant']]} ({method_label(row['method'])}) {_share(row)}"
            for row in differ[differ["task"] == task].to_dict("records")
        )
        count = int((tried["task"] == task).sum())
        sentences.append(f"{task_label(str(task))}: {named or 'none'}, of {count} that acted.")
    sentences.append(
        f"All together: {len(differ)} of {len(tried)}; if no reading mattered, at most about "
        f"{ALPHA * len(tried):.0f} would be by chance."
    )
    if idle.any():
        names = listed(constants[name] for name in dict.fromkeys(varied[idle]["variant"]))
        sentences.append(
            f"Acted on nothing, each run being the baseline's, in {idle.sum()} trials: {names}."
        )
    return sentences


def one_species(campaign: Campaign) -> list[str]:
    """For each task in what share of its generations all genomes of a method were one species."""
    shares: dict[str, dict[str, list[float]]] = {}
    for cell in cells(campaign.configuration):
        species = campaign.runs(cell).rows["species"]
        if len(species):
            of_task = shares.setdefault(cell.task, {})
            of_task.setdefault(cell.method, []).append((species == 1).mean())
    return [
        f"{task_label(task)}: "
        + ", ".join(
            f"{method_label(method)} {np.mean(of_task[method]):.0%}"
            for method in shown_methods(campaign.configuration.budget)
            if method in of_task
        )
        + "."
        for task, of_task in shares.items()
    ]


def _comparison(effects: pd.DataFrame, outcome: str, against: str) -> pd.DataFrame:
    return effects[(effects["outcome"] == outcome) & (effects["against"] == against)]


def _apart(effects: pd.DataFrame, outcome: str, against: str) -> str:
    """The methods that are distinguishable in a comparison, by task and side."""
    here = _comparison(effects, outcome, against)
    found = []
    for task, rows in here[here["task"] != "all"].groupby("task", sort=False):
        for side in ("higher", "lower"):
            methods = [
                row["method"] for row in rows.to_dict("records") if _side(row).startswith(side)
            ]
            if methods:
                found.append(
                    f"{listed(map(method_label, methods))} on {task_label(str(task))} ({side})"
                )
    return ", ".join(found)


def _entry(row: Mapping[Any, Any]) -> str:
    if not row["seeds"]:
        return "--"
    entry = _difference(row)
    is_bold = _side(row).startswith(("higher", "lower")) and row["near_control"] is not True
    return f"{f'**{entry}**' if is_bold else entry}; {row['a12']:.2f}"


def _range(values: "pd.Series[float]") -> str:
    low, high = map(three_figures, (values.min(), values.max()))
    return f"{low} to {high}"


def _side(row: Mapping[Any, Any]) -> str:
    """What an interval of a difference lets one say."""
    if not row["seeds"]:
        return "cannot be compared with"
    if row["low"] > 0:
        return "higher than"
    return "lower than" if row["high"] < 0 else "not distinguishable from"


def _difference(row: Mapping[Any, Any]) -> str:
    """A difference of means with its interval, and the mark of a rule that is near control."""
    value, low, high = (three_figures(row[name]) for name in ("difference", "low", "high"))
    return f"{value} [{low}, {high}]{_mark(row)}"


def _name(row: Mapping[Any, Any]) -> str:
    return f"{method_label(row['method'])}{_mark(row)}"


def _mark(row: Mapping[Any, Any]) -> str:
    return NEAR_CONTROL_MARK if row["near_control"] is True else ""


def _share(row: Mapping[Any, Any]) -> str:
    return f"{row['a12']:.2f} [{row['low']:.2f}, {row['high']:.2f}]"
