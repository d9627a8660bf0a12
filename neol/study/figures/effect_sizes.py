"""A picture of the table of effect sizes: each method minus a baseline, task by task."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from neol.pictures.labels import method_label, task_label
from neol.pictures.style import GREY, WIDTH, Style, drawing, footer, styles
from neol.spec.constants import Budget
from neol.study.campaign.methods import shown_methods
from neol.study.outcomes.contrasts import WHY_THEY_DIFFER
from neol.study.outcomes.effects import COMPARISONS
from neol.study.outcomes.movement import NEAR_CONTROL_WORDS


def draw_effect_sizes(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Draw each method's difference of means with its interval; a cross is the paper's.

    A row of panels for each comparison, a column for each task. Hollow marks are near control.
    """
    looks = styles(shown_methods(budget))
    heights = [len(family.methods(budget)) + 1.6 for family in COMPARISONS]
    with drawing():
        figure = Figure(figsize=(WIDTH, 1.3 + 0.185 * sum(heights)))
        panels = figure.subplots(
            len(COMPARISONS), len(budget.tasks), squeeze=False, height_ratios=heights
        )
        for row, family in zip(panels, COMPARISONS, strict=True):
            methods = family.methods(budget)
            for axis, task in zip(row, budget.tasks, strict=True):
                here = table[
                    (table["outcome"] == family.outcome)
                    & (table["against"] == family.against)
                    & (table["task"] == task)
                ]
                _differences(axis, here, methods, looks)
            row[0].set_yticks(range(len(methods)), [method_label(each) for each in methods])
            title = f"{family.outcome}, minus {method_label(family.against)}'s"
            row[0].set_title(f"{title[0].upper()}{title[1:]}", loc="left", size=7.5, color=GREY)
        for axis, task in zip(panels[0], budget.tasks, strict=True):
            axis.annotate(
                task_label(task), (0.5, 1), (0, 18), xycoords="axes fraction", size=8.5,
                textcoords="offset points", ha="center", va="bottom",
            )  # fmt: skip
        lines = [
            f"{note} Lines: Welch's 95% intervals of the difference of means. Grey crosses: the "
            f"difference of the paper's printed means, or an arrow if it lies outside the panel. "
            f"Numbers: A12. {WHY_THEY_DIFFER}"
        ]
        if table["near_control"].eq(True).any():
            lines.append(f"Hollow: {NEAR_CONTROL_WORDS}.")
        footer(figure, "\n".join(lines))
    return figure


def _differences(
    axis: Axes, table: pd.DataFrame, methods: Sequence[str], looks: Mapping[str, Style]
) -> None:
    """Draw differences of means with their intervals, one below the other, and print A12."""
    axis.axvline(0, color=GREY, linewidth=0.7)
    limits = np.nan_to_num(table[["low", "high", "difference"]].to_numpy(dtype=float).ravel())
    reach = 1.12 * float(np.abs(limits).max(initial=0.0)) or 1.0
    for row in table.to_dict("records"):
        place, look = methods.index(row["method"]), looks[row["method"]]
        fill = "white" if row["near_control"] is True else look.colour
        axis.hlines(place, row["low"], row["high"], color=look.colour, linewidth=1.3)
        axis.plot(row["difference"], place, look.marker, color=look.colour,
                  markerfacecolor=fill, markersize=4)  # fmt: skip
        paper = row["paper_difference"]
        if abs(paper) <= reach:
            axis.plot(paper, place, "x", color=GREY, markersize=4)
        elif not math.isnan(paper):
            edge = math.copysign(reach, paper)
            axis.plot(edge, place, ">" if paper > 0 else "<", color=GREY, markersize=3.5,
                      clip_on=False)  # fmt: skip
        if not math.isnan(row["a12"]):
            axis.text(1.07, place, f"{row['a12']:.2f}", size=5.5, va="center", color=GREY,
                      transform=axis.get_yaxis_transform())  # fmt: skip
    axis.set_xlabel("method higher →", size=5.5, loc="right", labelpad=0, color=GREY)
    axis.set_xlim(-reach, reach)
    axis.set_ylim(len(methods) - 0.4, -0.6)
    axis.set_yticks([])
    axis.xaxis.set_major_locator(MaxNLocator(3, symmetric=True))
    axis.tick_params(axis="both", labelsize=6)
    axis.tick_params(axis="y", length=0, labelsize=7)
