"""Sentences on results, for the page docs/results.md and for the paper.

Every sentence is made of cells of a budget's tables. Where an interval includes 0, it says that two
methods are not distinguishable.
"""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from neol.pictures.labels import listed, method_label, task_label, three_figures, with_interval
from neol.study.campaign.variants import BASELINE, variants
from neol.study.outcomes.movement import NEAR_CONTROL_MARK
from neol.study.outcomes.statistics import ALPHA
from neol.study.tables.table import Table


def differences(effects: pd.DataFrame, outcome: str, against: str) -> list[str]:
    """Say for each task which methods end higher or lower than another one, and by how much."""
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


def differences_from_neat(table: Table) -> list[str]:
    """Say the same of Table 5 or 6, whose rows compare each rule with NEAT."""
    return differences(table.frame.assign(outcome=table.name, against="neat"), table.name, "neat")


def best_cells(cells_of_figure: pd.DataFrame) -> list[str]:
    """Say for each method of a heat map which cell is best, and whether others are as good.

    The frame has a row for each cell: see `neol.study.figures.heatmaps.heatmaps`.
    """
    sentences = []
    known = cells_of_figure.dropna(subset="mean")
    for method, here in known.groupby("method", sort=False):
        best = here.sort_values("mean").iloc[-1]
        rate = best["learning_rate"]
        place = f"P = {best['population']}" + ("" if pd.isna(rate) else f", eta = {rate:g}")
        near = int(here["near_best"].sum()) - 1
        others = f"{near} of {len(here) - 1} other cells are" if near != 1 else "one other cell is"
        sentences.append(
            f"{method_label(str(method))}: {place} is best ({three_figures(best['mean'])}); "
            f"{others} not distinguishable from it."
        )
    return sentences


def effects_table(effects: pd.DataFrame, against: str) -> list[list[str]]:
    """Return differences from a method: a head, then a row for each outcome and task.

    Each has its interval and A12; bold is distinguishable, unless the rule is near control.
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
    """Say how many tests of single rules remain significant after correction."""
    tested = effects.dropna(subset="p_holm")
    significant = tested[tested["p_holm"] < ALPHA]
    named = "; ".join(
        f"{row['outcome']}, {task_label(row['task'])}, {marked_name(row)} against "
        f"{method_label(row['against'])}"
        for row in significant.to_dict("records")
    )
    return (
        f"Of {len(tested)} tests of single rules (Welch's, two-sided), {len(significant)} "
        f"have p < {ALPHA} after Holm's correction{f': {named}' if named else ''}."
    )


def sensitive_constants(table: pd.DataFrame) -> list[str]:
    """Say for each task which changed constants are distinguishable from the baseline, and how."""
    varied = table[(table["variant"] != BASELINE) & (table["pairs"] > 0)]
    if varied.empty:
        return ["No run of the sensitivity study is here."]
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
        sentences.append(f"{task_label(str(task))}: {named or 'none'}, of {count} variants.")
    sentences.append(
        f"In all, {len(differ)} of {len(tried)} variants; chance alone would give about "
        f"{ALPHA * len(tried):.0f}."
    )
    if idle.any():
        names = listed(constants[name] for name in dict.fromkeys(varied[idle]["variant"]))
        sentences.append(
            f"{idle.sum()} further trials changed nothing, because every run equals the "
            f"baseline's: {names}."
        )
    return sentences


def _comparison(effects: pd.DataFrame, outcome: str, against: str) -> pd.DataFrame:
    return effects[(effects["outcome"] == outcome) & (effects["against"] == against)]


def _entry(row: Mapping[Any, Any]) -> str:
    if not row["seeds"]:
        return "--"
    entry = _difference(row)
    is_bold = _side(row).startswith(("higher", "lower")) and row["near_control"] is not True
    return f"{f'**{entry}**' if is_bold else entry}; {row['a12']:.2f}"


def _side(row: Mapping[Any, Any]) -> str:
    """Return what the interval of a difference supports: higher, lower or not distinguishable."""
    if not row["seeds"]:
        return "cannot be compared with"
    if row["low"] > 0:
        return "higher than"
    return "lower than" if row["high"] < 0 else "not distinguishable from"


def _difference(row: Mapping[Any, Any]) -> str:
    """Format a difference of means with its interval, and the mark of a rule near control."""
    return f"{with_interval(row['difference'], row['low'], row['high'])}{_mark(row)}"


def marked_name(row: Mapping[Any, Any]) -> str:
    """Return a row's method, with the mark of a rule near control."""
    return f"{method_label(row['method'])}{_mark(row)}"


def _mark(row: Mapping[Any, Any]) -> str:
    return NEAR_CONTROL_MARK if row["near_control"] is True else ""


def _share(row: Mapping[Any, Any]) -> str:
    return f"{row['a12']:.2f} [{row['low']:.2f}, {row['high']:.2f}]"
