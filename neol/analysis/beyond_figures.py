"""Pictures of the tables in `beyond`."""

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator

from neol.analysis.beyond import COMPARISONS, RULES
from neol.analysis.labels import METHODS, task_label
from neol.analysis.style import GREY, STYLES, WIDTH, drawing, footer
from neol.sensitivity import BASELINE

GROUND = {"facecolor": "white", "edgecolor": "none", "pad": 0.4}
"""Behind words that lines run through."""
NO_LINE = (
    "A mark without a line: all runs tie, or all of one side are higher, and so are all resamples; "
    "that does not make it certain."
)
METRIC_LABELS = {
    "score": "SCORE",
    "equal_evaluations": "Best so far,\nequal evaluations",
    "equal_steps": "Best so far,\nequal steps",
}


def effects(table: pd.DataFrame, tasks: Sequence[str], note: str) -> Figure:
    """A12 of each rule with its interval; a cross is the paper's, from its p-value."""
    with drawing():
        columns = [*tasks, "all"]
        figure = Figure(figsize=(WIDTH, 3.6))
        axes = figure.subplots(1, len(columns), sharey=True, sharex=True)
        places = {
            (name, rule): -(group * (len(RULES) + 0.8) + position)
            for group, (name, *_) in enumerate(COMPARISONS)
            for position, rule in enumerate(RULES)
        }
        for axis, task in zip(axes, columns, strict=True):
            axis.axvline(0.5, color=GREY, linewidth=0.7)
            axis.set_title("All tasks" if task == "all" else task_label(task))
            for row in table[table["task"] == task].to_dict("records"):
                place = places[row["comparison"], row["method"]]
                _interval(axis, place, row, "a12")
                axis.plot(row["paper_a12"], place, "x", color="black", markersize=4)
            axis.set_xlim(-0.04, 1.04)
            axis.xaxis.set_major_locator(FixedLocator([0, 0.5, 1]))
        axes[0].set_yticks(list(places.values()), [METHODS[rule] for _, rule in places])
        for axis in axes:
            axis.tick_params(axis="y", length=0)
        for group, (_, _, metric, against, _) in enumerate(COMPARISONS):
            outcome = "SCORE" if metric == "score" else "Final fitness"
            text = f"{outcome} vs {METHODS[against]}"
            place = 0.62 - group * (len(RULES) + 0.8)
            label = axes[0].text(-0.01, place, text, size=6.5, color=GREY, bbox=GROUND)
            label.set_in_layout(False)
        axes[0].set_ylim(min(places.values()) - 0.5, 1.2)
        axes[len(columns) // 2].set_xlabel("Probability that a run of the rule ends higher (A12)")
        explanation = (
            "Lines: 95% intervals (stratified bootstrap); crosses: the paper's, from its p-values."
        )
        if (table["low"] == table["high"]).any():
            explanation += f" {NO_LINE}"
        footer(figure, f"{note} {explanation}")
    return figure


def profiles(table: pd.DataFrame, note: str) -> Figure:
    """Performance profiles over all tasks."""
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.9))
        axis = figure.subplots()
        for method in _methods(table):
            rows, style = table[table["method"] == method], STYLES[method]
            axis.plot(
                rows["threshold"],
                rows["share"],
                label=METHODS[method],
                color=style.colour,
                linestyle=style.line,
                marker=style.marker,
                markevery=(2 * list(STYLES).index(method), 12),
            )
            band = rows["threshold"], rows["low"], rows["high"]
            axis.fill_between(*band, color=style.colour, alpha=0.12, linewidth=0)
        axis.set_xlabel("Final best fitness / Gymnasium's reward threshold")
        axis.set_ylabel("Share of runs above it")
        axis.set_ylim(-0.02, 1.02)
        handles, names = axis.get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper center", ncols=5)
        explanation = "Bands: 95% intervals (stratified bootstrap)."
        below = 1 - table.loc[table["threshold"] == table["threshold"].min(), "share"]
        if (below > 0).any():
            explanation += f" Left of the axis: up to {below.max():.0%} of a method's runs."
        footer(figure, f"{note} {explanation}")
    return figure


def aggregates(table: pd.DataFrame, note: str) -> Figure:
    """Interquartile means of each task and of all."""
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.9))
        axis = figure.subplots()
        tasks = list(dict.fromkeys(table["task"]))
        methods = _methods(table)
        for row in table.to_dict("records"):
            offset = 0.15 * (methods.index(row["method"]) - (len(methods) - 1) / 2)
            _interval(axis, -tasks.index(row["task"]) - offset, row, "iqm")
        labels = ["All tasks" if task == "all" else task_label(task) for task in tasks]
        axis.set_yticks([-position for position in range(len(tasks))], labels)
        axis.tick_params(axis="y", length=0)
        axis.set_xlabel(
            "Interquartile mean of the final best fitness / Gymnasium's reward threshold"
        )
        _legend(figure, methods)
        footer(figure, f"{note} Lines: 95% intervals (stratified bootstrap).")
    return figure


def efficiency(table: pd.DataFrame, tasks: Sequence[str], note: str) -> Figure:
    """SCORE beside the best-so-far fitness at equal cost, over the population size."""
    with drawing():
        figure = Figure(figsize=(WIDTH, 4.6))
        axes = figure.subplots(3, len(tasks), sharex=True, squeeze=False)
        for (row, (metric, label)), (column, task) in (
            (row, column) for row in enumerate(METRIC_LABELS.items()) for column in enumerate(tasks)
        ):
            axis = axes[row, column]
            here = table[(table["metric"] == metric) & (table["task"] == task)]
            _by_population(axis, here)
            if row == 0:
                axis.set_title(task_label(task))
            if column == 0:
                axis.set_ylabel(label)
            if row == 2:
                axis.set_xlabel("Population size")
        figure.align_ylabels(axes[:, 0])
        handles, names = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper center", ncols=5)
        explanation = (
            "Means over learning rates, then seeds, with 95% intervals. Equal cost: up to where "
            "all runs of a task have come."
        )
        footer(figure, f"{note} {explanation}")
    return figure


def selection(table: pd.DataFrame, tasks: Sequence[str], note: str) -> Figure:
    """Final best fitness minus the champion's mean return in fresh episodes."""
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.3))
        axes = figure.subplots(1, len(tasks), squeeze=False)[0]
        for axis, task in zip(axes, tasks, strict=True):
            axis.axhline(0, color=GREY, linewidth=0.7)
            _by_population(axis, table[table["task"] == task])
            axis.set_title(task_label(task))
            axis.set_xlabel("Population size")
        axes[0].set_ylabel("Training maximum\n− held-out mean (return)")
        handles, names = axes[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper center", ncols=5)
        explanation = "Means over learning rates, then seeds, with 95% intervals."
        without = table["without_value"].sum()
        if without:
            explanation += f" Left out: {without} runs whose champion failed in all fresh episodes."
        footer(figure, f"{note} {explanation}")
    return figure


def sensitivity(table: pd.DataFrame, tasks: Sequence[str], seeds: int, note: str) -> Figure:
    """How often a variant beats the baseline's run of a seed, with interval; a column for a task.

    A trial that lacks some of its `seeds` says how many it has.
    """
    with drawing():
        names = [name for name in dict.fromkeys(table["variant"]) if name != BASELINE]
        figure = Figure(figsize=(WIDTH, 0.24 * len(names) + 1.1))
        axes = figure.subplots(1, len(tasks), sharey=True, sharex=True, squeeze=False)[0]
        for axis, task in zip(axes, tasks, strict=True):
            axis.axvline(0.5, color=GREY, linewidth=0.7)
            axis.set_title(task_label(task))
            here = table[table["task"] == task]
            for row in here[here["variant"] != BASELINE].to_dict("records"):
                place = (-0.15 if row["method"] == "neat" else 0.15) - names.index(row["variant"])
                _interval(axis, place, row, "a12")
                if row["seeds"] < seeds:
                    there = f"{row['seeds']}/{seeds}"
                    axis.text(0, place, there, size=5, va="center", color=GREY, bbox=GROUND)
            axis.set_xlim(-0.04, 1.04)
            axis.xaxis.set_major_locator(FixedLocator([0, 0.5, 1]))
            axis.tick_params(axis="y", length=0)
        axes[0].set_yticks([-position for position in range(len(names))], names)
        axes[len(axes) // 2].set_xlabel(
            "Share of seeds whose champion is above the baseline's in fresh episodes"
        )
        _legend(figure, _methods(table))
        lacking = int((table["seeds"] < seeds).sum())
        warning = [f"Seeds are missing: {lacking} of {len(table)} trials are incomplete."]
        lines = [f"{note} Lines: 95% intervals (bootstrap).", *(warning if lacking else [])]
        if (table["low"] == table["high"])[table["variant"] != BASELINE].any():
            lines[0] += f" {NO_LINE}"
        footer(figure, "\n".join(lines))
    return figure


def _by_population(axis: Axes, table: pd.DataFrame) -> None:
    """A method's mean over the population size, with intervals; methods side by side."""
    if table["mean"].isna().all():
        axis.text(0.5, 0.5, "no common range", transform=axis.transAxes, ha="center", color=GREY)
        axis.yaxis.set_major_locator(NullLocator())
        return
    populations = sorted(table["population"].unique())
    for method in _methods(table):
        rows = table[table["method"] == method].sort_values("population").dropna(subset="mean")
        style = STYLES[method]
        shift = 0.022 * len(populations) * (list(STYLES).index(method) - 2)
        axis.errorbar(
            [populations.index(each) + shift for each in rows["population"]],
            rows["mean"],
            [rows["mean"] - rows["low"], rows["high"] - rows["mean"]],
            label=METHODS[method],
            color=style.colour,
            linestyle=style.line,
            marker=style.marker,
            elinewidth=0.8,
        )
    axis.set_xticks(range(len(populations)), [str(each) for each in populations])
    axis.xaxis.set_minor_locator(NullLocator())
    axis.yaxis.set_major_locator(MaxNLocator(4))


def _legend(figure: Figure, methods: Sequence[str]) -> None:
    """A figure's methods, where what is plotted has no labels."""
    handles = [
        Line2D([], [], color=STYLES[method].colour, marker=STYLES[method].marker)
        for method in methods
    ]
    labels = [METHODS[method] for method in methods]
    figure.legend(handles, labels, loc="outside upper center", ncols=5)


def _methods(table: pd.DataFrame) -> list[str]:
    """Those that a table has, in the order of every figure."""
    return [method for method in STYLES if method in set(table["method"])]


def _interval(axis: Axes, place: float, row: Mapping[Hashable, Any], value: str) -> None:
    style = STYLES[row["method"]]
    axis.hlines(place, row["low"], row["high"], color=style.colour, linewidth=1.3)
    axis.plot(row[value], place, style.marker, color=style.colour, markersize=4)
