"""The picture of docs/readings.md: each reading's baselines beside the paper's."""

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from neol.network.rules import BASELINES
from neol.pictures.labels import method_label
from neol.pictures.style import GREY, WIDTH, drawing, styles
from neol.study.outcomes.baselines import COUNTINGS, QUANTITIES

TITLES = {"final": "final best fitness", "mean": "mean best fitness"}
MARKERS = dict(zip(COUNTINGS, ("o", "s"), strict=True))


def readings_picture(table: pd.DataFrame) -> Figure:
    """Draw a panel for each of the paper's four means, a row for each reading in table order.

    A band is the paper's mean ± SD. A mark is our mean with the 99% predictive interval of the
    mean of 30 further runs; filled marks count the best of the generation, open ones the best so
    far.
    """
    with drawing():
        return _drawn(table)


def _drawn(table: pd.DataFrame) -> Figure:
    readings = list(dict.fromkeys(table["reading"]))
    colours = styles(BASELINES)
    figure = Figure(figsize=(WIDTH, 1.1 + 0.22 * len(readings)))
    axes = figure.subplots(1, 4, sharey=True)
    panels = [(method, quantity) for method in BASELINES for quantity in QUANTITIES]
    for axis, (method, quantity) in zip(axes, panels, strict=True):
        rows = table[(table["method"] == method) & (table["quantity"] == quantity)]
        paper = rows.iloc[0]
        low, high = (paper["paper_mean"] + side * paper["paper_sd"] for side in (-1, 1))
        axis.axvspan(low, high, color="0.88")
        axis.axvline(paper["paper_mean"], color=GREY, linewidth=0.7)
        for shift, counting in zip((-0.14, 0.14), COUNTINGS, strict=True):
            counted = rows[rows["counting"] == counting]
            places = [readings.index(reading) + shift for reading in counted["reading"]]
            colour = colours[method].colour
            axis.hlines(places, counted["mean_low"], counted["mean_high"], colour, linewidth=0.8)
            filled = colour if counting == COUNTINGS[0] else "white"
            axis.plot(
                counted["mean"], places, MARKERS[counting], color=colour, markerfacecolor=filled
            )
        axis.set_title(f"{method_label(method)},\n{TITLES[quantity]}")
        # A few runs that differ much have intervals far wider than all means.
        means = [*rows["mean"].dropna(), low, high]
        margin = 0.15 * (max(means) - min(means))
        axis.set_xlim(min(means) - margin, max(means) + margin)
    axes[0].set_yticks(range(len(readings)), readings)
    axes[0].invert_yaxis()
    figure.legend(
        handles=[
            Line2D([], [], color=GREY, linestyle="", marker="o", label=f"best {COUNTINGS[0]}"),
            Line2D(
                [],
                [],
                color=GREY,
                linestyle="",
                marker="s",
                markerfacecolor="white",
                label=f"best {COUNTINGS[1]}",
            ),
            Line2D([], [], color="0.88", linewidth=6, label="the paper's mean ± SD"),
        ],
        loc="outside lower center",
        ncols=3,
    )
    return figure
