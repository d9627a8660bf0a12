"""What the results say in words, for the page docs/results.md and for the paper.

Every sentence is made of cells of a budget's tables and says no more than the interval beside it: a
comparison whose interval holds "no difference" was not told apart.
"""

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from neol.pictures.labels import listed, method_label, task_label, three_figures
from neol.study.campaign.grid import cells
from neol.study.campaign.methods import shown_methods
from neol.study.campaign.variants import BASELINE, variants
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.effects import OUTCOMES
from neol.study.outcomes.statistics import ALPHA


def verdicts(ledger: pd.DataFrame) -> list[str]:
    """How many claims came out how, and the tasks whose runs decided those that are decided."""
    claims = ledger.groupby("claim", sort=False)
    verdict = claims["verdict"].first()
    counts = Counter(verdict)
    sentences = [
        f"Of {len(verdict)} claims of the paper this budget supports {counts['supported']}, "
        f"contradicts {counts['contradicted']} and leaves {counts['undecided']} open; claims "
        "overlap, so that is no count of independent findings."
    ]
    for each in ("supported", "contradicted"):
        parts = ledger[(ledger["verdict"] == each) & (ledger["part_verdict"] == each)]
        tasks = dict.fromkeys(task for some in parts["tasks"] for task in some.split(","))
        if tasks:
            sentences.append(f"What is {each} is about {listed(map(task_label, tasks))}.")
    return sentences


def summary(effects: pd.DataFrame) -> list[str]:
    """Which methods are told apart from NEAT, and from NEAT (w/o), by which outcome."""

    def told(against: str) -> str:
        return "; ".join(
            f"in {outcome}, {_apart(effects, outcome, against) or 'none'}" for outcome in OUTCOMES
        )

    return [
        "Told apart from NEAT, by the 95% interval of the probability that a run ends higher, are: "
        f"{told('neat')}.",
        f"From NEAT (w/o), which neither learns nor mutates weights: {told('neat_wo')}.",
        "What a rule shares with NEAT (w/o) is no effect of learning.",
    ]


def told_apart(effects: pd.DataFrame, outcome: str, against: str) -> list[str]:
    """For each task, and for all together, which methods end above or below another one: A12."""
    sentences = []
    for task, rows in _comparison(effects, outcome, against).groupby("task", sort=False):
        sides: dict[str, list[str]] = {}
        for row in rows.to_dict("records"):
            share = f" {_share(row)}" if row["seeds"] else ""
            sides.setdefault(_side(row), []).append(f"{method_label(row['method'])}{share}")
        other = method_label(against)
        said = "; ".join(f"{', '.join(some)} {side} {other}" for side, some in sides.items())
        sentences.append(f"{_place(str(task))}: {said}.")
    return sentences


def effects_table(effects: pd.DataFrame, against: str) -> list[list[str]]:
    """A12 against a method: a head, then a row for each outcome and task; bold is told apart."""
    here = effects[effects["against"] == against]
    methods = list(dict.fromkeys(here["method"]))
    rows = [["outcome", "task", *map(method_label, methods)]]
    for (outcome, task), some in here.groupby(["outcome", "task"], sort=False):
        by_method = {row["method"]: row for row in some.to_dict("records")}
        entries = [_entry(by_method[method]) for method in methods]
        rows.append([str(outcome), _place(str(task)), *entries])
    return rows


def after_correction(effects: pd.DataFrame) -> str:
    """How many of the declared tests remain significant."""
    tested = effects.dropna(subset="p_holm")
    significant = tested[tested["p_holm"] < ALPHA]
    named = "; ".join(
        f"{row['outcome']}, {task_label(row['task'])}, {method_label(row['method'])} against "
        f"{method_label(row['against'])}"
        for row in significant.to_dict("records")
    )
    return (
        f"Of {len(tested)} one-sided tests of the declared family, {len(significant)} have p < "
        f"{ALPHA} after Holm's correction{f': {named}' if named else ''}."
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
    """The methods that are told apart in a comparison, by task and side."""
    here = _comparison(effects, outcome, against)
    found = []
    for task, rows in here[here["task"] != "all"].groupby("task", sort=False):
        for side in ("above", "below"):
            methods = [row["method"] for row in rows.to_dict("records") if _side(row) == side]
            if methods:
                found.append(
                    f"{listed(map(method_label, methods))} on {task_label(str(task))} ({side})"
                )
    return ", ".join(found)


def _entry(row: Mapping[Any, Any]) -> str:
    if not row["seeds"]:
        return "--"
    return f"**{_share(row)}**" if _side(row) in ("above", "below") else _share(row)


def _place(task: str) -> str:
    return "All tasks together" if task == "all" else task_label(task)


def _range(values: "pd.Series[float]") -> str:
    low, high = map(three_figures, (values.min(), values.max()))
    return f"{low} to {high}"


def _side(row: Mapping[Any, Any]) -> str:
    """What an interval of A12 lets one say."""
    if not row["seeds"]:
        return "cannot be compared with"
    return "above" if row["low"] > 0.5 else "below" if row["high"] < 0.5 else "not told apart from"


def _share(row: Mapping[Any, Any]) -> str:
    return f"{row['a12']:.2f} [{row['low']:.2f}, {row['high']:.2f}]"
