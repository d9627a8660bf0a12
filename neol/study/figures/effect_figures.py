"""Figures beyond the paper's: pictures of the other tables of `effects` and `sensitivity`."""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator

from neol.pictures.labels import method_label, task_label
from neol.pictures.style import GREY, WIDTH, Style, drawing, footer
from neol.spec.constants import Budget
from neol.study.campaign.variants import BASELINE
from neol.study.figures.figure import looks_of
from neol.study.outcomes.effects import thresholds
from neol.study.outcomes.movement import NEAR_CONTROL, NEAR_CONTROL_WORDS
from neol.study.outcomes.outcomes import EQUAL

GROUND = {"facecolor": "white", "edgecolor": "none", "pad": 0.4}
"""Background of words that lines run through."""
NO_LINE = (
    "A mark without a line: all runs tie, or all of one side are higher, so every resample agrees; "
    "this is not certainty."
)
EFFICIENCY_ROWS = {
    ("score", "population"): "SCORE",
    ("score_per_genome", "population"): "SCORE / P",
    ("equal_evaluations", "population"): "Best return so far,\nevaluations equal\nwithin a size",
    ("equal_steps", "population"): "Best return so far,\nsteps equal\nwithin a size",
    ("equal_evaluations", "populations"): "Best return so far,\nevaluations equal\nin all sizes",
    ("equal_steps", "populations"): "Best return so far,\nsteps equal\nin all sizes",
}
"""Labels of rows by metric and range, which are those of `outcomes.effects.efficiency`."""


def draw_profiles(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Draw performance profiles over all tasks."""
    looks = looks_of(table, budget)
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.9))
        axis = figure.subplots()
        for place, (method, style) in enumerate(looks.items()):
            rows = table[table["method"] == method]
            axis.step(
                rows["threshold"],
                rows["share"],
                where="post",
                label=method_label(method),
                color=style.colour,
                linestyle=style.line,
                marker=style.marker,
                markevery=((place + 0.5) / len(looks) / 5, 0.2),
            )
            band = rows["threshold"], rows["low"], rows["high"]
            axis.fill_between(*band, step="post", color=style.colour, alpha=0.12, linewidth=0)
        axis.set_xlabel("Final best fitness / Gymnasium's reward threshold")
        axis.set_ylabel("Share of runs above it")
        axis.set_ylim(-0.02, 1.02)
        _legend(figure, looks)
        footer(
            figure, f"{note} Bands: 95% intervals (stratified bootstrap).{_no_threshold(budget)}"
        )
    return figure


def draw_aggregates(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Draw interquartile means of each task, and the mean of several tasks."""
    looks, methods = looks_of(table, budget), list(looks_of(table, budget))
    tasks = list(dict.fromkeys(table["task"]))
    with drawing():
        figure = Figure(figsize=(WIDTH, 0.9 + 0.1 * len(tasks) * (len(methods) + 1.5)))
        axis = figure.subplots()
        for row in table.to_dict("records"):
            offset = (methods.index(row["method"]) - (len(methods) - 1) / 2) / (len(methods) + 1.5)
            place = -tasks.index(row["task"]) - offset
            _interval(axis, place, row, "iqm", looks[row["method"]])
        labels = ["All tasks" if task == "all" else task_label(task) for task in tasks]
        axis.set_yticks([-position for position in range(len(tasks))], labels)
        axis.tick_params(axis="y", length=0)
        axis.set_xlabel(
            "Interquartile mean of the final best fitness / Gymnasium's reward threshold"
        )
        _legend(figure, looks)
        explanation = (
            "Lines: 95% intervals (stratified bootstrap); some are shorter than their mark."
        )
        if "all" in tasks:
            explanation += " All tasks: the mean of the tasks' own interquartile means."
        footer(figure, f"{note} {explanation}{_no_threshold(budget)}")
    return figure


def draw_efficiency(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Draw SCORE and the best-so-far fitness at equal cost, by population size."""
    looks = looks_of(table, budget)
    with drawing():
        figure = Figure(figsize=(WIDTH, 8.6))
        axes = figure.subplots(len(EFFICIENCY_ROWS), len(budget.tasks), sharex=True, squeeze=False)
        for row, ((metric, compared), label) in zip(axes, EFFICIENCY_ROWS.items(), strict=True):
            there = table[(table["metric"] == metric) & (table["compared"] == compared)]
            for axis, task in zip(row, budget.tasks, strict=True):
                _by_population(axis, there[there["task"] == task], looks)
            row[0].set_ylabel(label, size=7)
        for column, task in enumerate(budget.tasks):
            axes[0, column].set_title(task_label(task))
            axes[-1, column].set_xlabel("Population size")
        figure.align_ylabels(axes[:, 0])
        _legend(figure, looks)
        explanation = (
            "Means over learning rates, then seeds, with 95% intervals. Equal within a size: over "
            "the range that all runs of one population size share, so compare methods, not sizes. "
            "Equal in all sizes: "
        )
        footer(figure, f"{note} {explanation}{'; '.join(_ranges(table, budget))}.")
    return figure


def draw_selection_bias(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Draw final best fitness minus the champion's mean return in fresh episodes."""
    looks = looks_of(table, budget)
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.5))
        axes = figure.subplots(1, len(budget.tasks), squeeze=False)[0]
        for axis, task in zip(axes, budget.tasks, strict=True):
            axis.axhline(0, color=GREY, linewidth=0.7)
            _by_population(axis, table[table["task"] == task], looks)
            axis.set_title(task_label(task))
            axis.set_xlabel("Population size")
        axes[0].set_ylabel("Training maximum −\nheld-out mean (return)")
        _legend(figure, looks)
        explanation = "Means over learning rates, then seeds, with 95% intervals."
        without = table["without_value"].sum()
        if without:
            explanation += f" Left out: {without} runs whose champion failed in all fresh episodes."
        footer(figure, f"{note} {explanation}")
    return figure


def draw_learning(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Draw the effect of switching plasticity off in each cell, by how far its weights move."""
    looks = looks_of(table, budget)
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.7))
        axes = figure.subplots(1, len(budget.tasks), squeeze=False)[0]
        for axis, task in zip(axes, budget.tasks, strict=True):
            axis.axhline(0, color=GREY, linewidth=0.7)
            axis.axvspan(1e-9, NEAR_CONTROL, color=GREY, alpha=0.12, linewidth=0)
            here = table[(table["task"] == task) & table["switching_off"].notna()]
            if here.empty:
                axis.text(0.5, 0.6, "not played", transform=axis.transAxes, ha="center", color=GREY)
            for row in here.to_dict("records"):
                look, place = looks[row["method"]], row["movement_over_run"]
                axis.vlines(place, row["low"], row["high"], color=look.colour, linewidth=0.8)
                fill = "white" if row["near_control"] else look.colour
                axis.plot(place, row["switching_off"], look.marker, color=look.colour,
                          markerfacecolor=fill)  # fmt: skip
            moved = table.loc[table["movement_over_run"] > 0, "movement_over_run"]
            axis.set_xscale("log")
            if len(moved):
                axis.set_xlim(0.6 * moved.min(), 1.6 * moved.max())
            axis.set_title(task_label(task))
        axes[0].set_ylabel("Return without plasticity\n− return with it")
        _below(axes, "Path of a weight over the run / SD of initial weights")
        _legend(figure, looks)
        footer(
            figure,
            f"{note} One mark for each population and learning rate: means over champions with 95% "
            f"intervals, below 0 where plasticity helps. Grey or hollow: {NEAR_CONTROL_WORDS}.",
        )
    return figure


def draw_sensitivity(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Draw how often a variant's run beats the baseline's of the same seed, a column for each task.

    A trial that lacks some of its seeds, or of its pairs with the baseline, states its number.
    """
    looks = looks_of(table, budget)
    names = [name for name in dict.fromkeys(table["variant"]) if name != BASELINE]
    varied = table[table["variant"] != BASELINE]
    with drawing():
        figure = Figure(figsize=(WIDTH, 0.27 * len(names) + 1.1))
        tasks = list(dict.fromkeys(table["task"]))
        columns = max(1, len(tasks))
        axes = figure.subplots(1, columns, sharey=True, sharex=True, squeeze=False)[0]
        if not tasks:
            axes[0].set_axis_off()
        for axis, task in zip(axes, tasks, strict=False):
            _from_0_to_1(axis, task_label(task))
            here = varied[varied["task"] == task]
            counts = here.groupby("variant")["method"].transform("size")
            for row in here.assign(beside=counts > 1).to_dict("records"):
                offset = 0.2 * row["beside"] * (-1 if row["method"] == "neat" else 1)
                place = offset - names.index(row["variant"])
                _interval(axis, place, row, "a12", looks[row["method"]])
                if row["pairs"] < row["planned"]:
                    there = f"{row['pairs']}/{row['planned']}"
                    axis.text(0, place, there, size=5.5, va="center", color=GREY, bbox=GROUND)
        axes[0].set_yticks([-position for position in range(len(names))], names)
        axes[0].set_ylim(-len(names) + 0.4, 0.6)
        _below(axes, "Share of seeds whose champion is above the baseline's in fresh episodes")
        _legend(figure, looks)
        lines = [f"{note} Lines: 95% intervals (bootstrap)."]
        if (varied["low"] == varied["high"]).any():
            lines[0] += f" {NO_LINE}"
        lacking = int((table["seeds"] < table["planned"]).sum())
        if lacking:
            lines.append(f"Seeds are missing: {lacking} of {len(table)} trials are incomplete.")
        failed = int(table["without_value"].sum())
        if failed:
            lines.append(f"Left out: {failed} runs whose champion failed in all fresh episodes.")
        footer(figure, "\n".join(lines))
    return figure


def _by_population(axis: Axes, table: pd.DataFrame, looks: Mapping[str, Style]) -> None:
    """Draw each method's mean by population size, with intervals; methods are side by side."""
    if table["mean"].isna().all():
        axis.text(0.5, 0.5, "no common range", transform=axis.transAxes, ha="center", color=GREY)
        axis.yaxis.set_major_locator(NullLocator())
        return
    populations = sorted(table["population"].unique())
    for position, (method, style) in enumerate(looks.items()):
        rows = table[table["method"] == method].sort_values("population").dropna(subset="mean")
        shift = 0.022 * len(populations) * (position - (len(looks) - 1) / 2)
        axis.errorbar(
            [populations.index(each) + shift for each in rows["population"]],
            rows["mean"],
            [rows["mean"] - rows["low"], rows["high"] - rows["mean"]],
            color=style.colour,
            linestyle=style.line,
            marker=style.marker,
            elinewidth=0.8,
        )
    axis.set_xticks(range(len(populations)), [str(each) for each in populations])
    axis.xaxis.set_minor_locator(NullLocator())
    axis.yaxis.set_major_locator(MaxNLocator(4))


def _ranges(table: pd.DataFrame, budget: Budget) -> Iterable[str]:
    """Say for each task over which evaluations and steps all population sizes are compared."""
    for task in budget.tasks:
        ranges = []
        for metric, column in EQUAL.items():
            here = table[
                (table["task"] == task)
                & (table["metric"] == metric)
                & (table["compared"] == "populations")
            ]
            first, last = here["first"].min(), here["last"].min()
            if first < last:
                name = column.replace("env_steps", "steps")
                ranges.append(f"{first:,.0f} to {last:,.0f} {name}")
        yield f"{task_label(task)}, {' and '.join(ranges) or 'no common range'}"


def _no_threshold(budget: Budget) -> str:
    """Say which tasks have no threshold and are therefore left out."""
    without = [task_label(task) for task in budget.tasks if task not in thresholds()]
    return f" Left out (no reward threshold): {', '.join(without)}." if without else ""


def _from_0_to_1(axis: Axes, title: str) -> None:
    """Set an axis to shares from 0 to 1, with its middle marked."""
    axis.axvline(0.5, color=GREY, linewidth=0.7)
    axis.set_title(title)
    axis.set_xlim(-0.04, 1.04)
    axis.xaxis.set_major_locator(FixedLocator([0, 0.5, 1]))
    axis.tick_params(axis="y", length=0)


def _below(axes: Sequence[Axes], label: str) -> None:
    """Put one label below the middle of a row of axes."""
    even = len(axes) % 2 == 0
    axes[len(axes) // 2].set_xlabel(label, x=-0.02 if even else 0.5)


def _legend(figure: Figure, looks: Mapping[str, Style]) -> None:
    """Add a legend of the methods."""
    handles = [
        Line2D([], [], color=style.colour, linestyle=style.line, marker=style.marker)
        for style in looks.values()
    ]
    labels = [method_label(method) for method in looks]
    figure.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), 6))


def _interval(
    axis: Axes, place: float, row: Mapping[Hashable, Any], value: str, style: Style
) -> None:
    axis.hlines(place, row["low"], row["high"], color=style.colour, linewidth=1.3)
    axis.plot(row[value], place, style.marker, color=style.colour, markersize=4)
