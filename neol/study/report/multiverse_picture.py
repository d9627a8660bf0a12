"""The multiverse as a specification curve: every question's answer under every reading."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from neol.network.rules import BASELINES
from neol.pictures.labels import method_label, task_label
from neol.pictures.style import GREY, WIDTH, drawing, styles
from neol.study.campaign.multiverse import choices
from neol.study.outcomes.multiverse import METRICS

CURVE_HEIGHT, MARKS_HEIGHT = 0.9, 0.5
"""Heights of a panel's two parts, in inches."""


def specification_curve(table: pd.DataFrame, task: str) -> Figure:
    """Draw a task's questions: a column for each rule, a row for each outcome and other method.

    The upper part of a panel has the difference of means under each reading, the least first, with
    its interval; in colour where that excludes 0. The lower part marks the choices in which the
    reading differs from the first one.
    """
    with drawing():
        return _drawn(table[table["task"] == task], task)


def _drawn(table: pd.DataFrame, task: str) -> Figure:
    methods = list(dict.fromkeys(table["method"]))
    panels = [(metric, against) for against in BASELINES for metric in METRICS]
    heights = [CURVE_HEIGHT, MARKS_HEIGHT] * len(panels)
    figure = Figure(figsize=(WIDTH, 1.2 + sum(heights)))
    axes = figure.subplots(
        len(heights), len(methods), sharex=True, squeeze=False, height_ratios=heights
    )
    for row, (metric, against) in enumerate(panels):
        for column, method in enumerate(methods):
            here = table[(table["metric"] == metric) & (table["against"] == against)]
            curve = here[here["method"] == method].sort_values("difference", kind="stable")
            upper, lower = axes[2 * row, column], axes[2 * row + 1, column]
            _draw_curve(upper, curve, styles(methods)[method].colour)
            _draw_choices(lower, curve, named=column == 0)
            if column == 0:
                words = f"{METRICS[metric]}\nminus {method_label(against)}"
                upper.set_ylabel(words, fontsize=6.5)
            if row == 0:
                upper.set_title(method_label(method))
    figure.suptitle(f"{task_label(task)}: rule minus the other method, under each reading")
    figure.legend(
        handles=[
            Line2D([], [], color="black", marker="o", label="distinguishable (coloured)"),
            Line2D([], [], color="0.7", marker="o", label="not distinguishable"),
            Line2D([], [], color=GREY, marker="s", linestyle="", label="another option"),
        ],
        loc="outside lower center",
        ncols=3,
    )
    return figure


def _draw_curve(axis: Axes, curve: pd.DataFrame, colour: str) -> None:
    places = np.arange(len(curve))
    colours = [colour if clear else "0.7" for clear in curve["distinguishable"]]
    axis.axhline(0, color=GREY, linewidth=0.6)
    axis.vlines(places, curve["low"], curve["high"], colours, linewidth=0.8)
    axis.scatter(places, curve["difference"], s=5, c=colours, zorder=3)
    axis.tick_params(bottom=False, labelbottom=False)


def _draw_choices(axis: Axes, curve: pd.DataFrame, *, named: bool) -> None:
    found = choices()
    for line, (name, choice) in enumerate(found.items()):
        other = np.flatnonzero(curve[name] != next(iter(choice.options)))
        axis.plot(other, np.full(len(other), line), "s", color=GREY, markersize=1.8)
    axis.set_ylim(len(found) - 0.4, -0.6)
    axis.set_yticks(range(len(found)), list(found) if named else [""] * len(found))
    axis.tick_params(left=False, bottom=False, labelbottom=False, labelsize=5)
    for spine in axis.spines.values():
        spine.set_visible(False)
