"""The paper's Figures 4 to 11, drawn from a table with a row for each cell of a grid."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
import seaborn
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from neol.pictures.labels import drawn, method_label, three_figures
from neol.pictures.style import COLOUR_MAP, WIDTH, drawing, footer
from neol.study.outcomes.movement import NEAR_CONTROL_MARK, NEAR_CONTROL_NOTE
from neol.study.outcomes.statistics import Floats


def heatmaps(
    cells: pd.DataFrame,
    *,
    title: str,
    methods: Sequence[str],
    populations: Sequence[int],
    learning_rates: Sequence[float],
    seeds: int,
    note: str,
) -> Figure:
    """Figures 4 to 11: the mean over seeds for every population and rate, with its standard error.

    `cells` has a row for each cell: method, population, learning_rate (NaN for a method without
    one, which has a single row), `seeds`, `mean`, `standard_error`, `near_control`, and
    `near_best`, the cells of a method that are not distinguishable from its best. All panels share
    one colour scale. The best cell has a thick frame, those near it a thin one; a cell that lacks
    seeds is hatched and says how many it has.
    """
    grids = {
        method: _grid(cells[cells["method"] == method], populations, learning_rates)
        for method in methods
    }
    means = np.concatenate([grid["mean"].ravel() for grid in grids.values()])
    scale = _scale(means[np.isfinite(means)])
    with drawing():
        figure = Figure(figsize=(WIDTH, 0.36 * len(learning_rates) + 1.35))
        figure.suptitle(title, x=0.01, ha="left")
        axes = figure.subplots(1, len(methods), squeeze=False)[0]
        for position, (axis, method) in enumerate(zip(axes, methods, strict=True)):
            grid = grids[method]
            mean = grid["mean"]
            seaborn.heatmap(
                mean,
                ax=axis,
                cmap=COLOUR_MAP,
                vmin=scale.vmin,
                vmax=scale.vmax,
                cbar=False,
                linewidths=0.8,
                xticklabels=populations,
                yticklabels=[f"{rate:g}" for rate in learning_rates] if position == 0 else [],
            )
            # The lowest rate is at the bottom. A method without rates stands between them.
            bottom = (len(mean) - len(learning_rates)) / 2
            axis.set_ylim(bottom, bottom + len(learning_rates))
            if len(mean) < len(learning_rates):
                middle, above = len(populations) / 2, len(mean) + 0.15
                axis.text(middle, above, "no learning rate", ha="center", fontsize=6.5)
            axis.set_title(method_label(method))
            axis.set_xlabel("Population size")
            axis.tick_params(length=0, rotation=0)
            _write_cells(axis, grid, seeds, scale)
        axes[0].set_ylabel("Learning rate")
        image = axes[0].collections[0]
        bar = figure.colorbar(image, ax=axes, fraction=0.02, pad=0.01, aspect=14)
        bar.outline.set_visible(False)
        bar.locator = MaxNLocator(4)
        lines = [f"{note} {_explained(cells)}"]
        lacking = sum(int((grid["seeds"] < seeds).sum()) for grid in grids.values())
        if lacking:
            lines.append(f"Hatched: {lacking} of {means.size} cells lack seeds.")
        footer(figure, "\n".join(lines))
    return figure


def _explained(cells: pd.DataFrame) -> str:
    """Explain the numbers, frames and marks of heat maps."""
    sentences = [
        "Means over seeds; beneath them, standard errors. Thick frame: a panel's highest mean, if "
        "it is unique; thin frames: cells not distinguishable from it (one-sided Welch tests, "
        "corrected for their number)."
    ]
    if cells["near_control"].any():
        sentences.append(NEAR_CONTROL_NOTE)
    return " ".join(sentences)


def _grid(
    cells: pd.DataFrame, populations: Sequence[int], rates: Sequence[float]
) -> dict[str, npt.NDArray[Any]]:
    """Return a method's cells by column: [rates, populations], one row if it has no rate."""
    rows = list(rates) if cells["learning_rate"].notna().any() else [0.0]
    places = pd.MultiIndex.from_product([rows, populations])
    keys = ["learning_rate", "population"]
    table = cells.assign(learning_rate=cells["learning_rate"].fillna(0.0)).set_index(keys)
    absent = {"seeds": 0, "near_control": False, "near_best": False}
    table = table.reindex(places).fillna(absent)
    kinds = {"mean": float, "standard_error": float, "seeds": int}
    kinds |= {"near_control": bool, "near_best": bool}
    shape = len(rows), len(populations)
    return {
        name: table[name].to_numpy().astype(kind).reshape(shape) for name, kind in kinds.items()
    }


def _scale(means: Floats) -> Normalize:
    """Scale colours from the lowest to the highest mean, with some width if all are equal."""
    if not len(means):
        return Normalize(0, 1)
    low, high = float(means.min()), float(means.max())
    margin = 0.005 * max(abs(low), abs(high), 1e-9) if np.isclose(low, high) else 0.0
    return Normalize(low - margin, high + margin)


def _write_cells(
    axis: Axes, grid: Mapping[str, npt.NDArray[Any]], seeds: int, scale: Normalize
) -> None:
    mean = grid["mean"]
    highest = mean == np.nanmax(mean) if np.isfinite(mean).any() else np.zeros(mean.shape, bool)
    is_single = highest.sum() == 1
    for (row, column), value in np.ndenumerate(mean):
        there = int(grid["seeds"][row, column])
        ink = "white" if there and scale(value) < 0.55 else "black"
        mark = NEAR_CONTROL_MARK if grid["near_control"][row, column] else ""
        text = drawn(three_figures(value)) + mark if there else "no runs"
        beneath = f"{there}/{seeds}" if 0 < there < seeds else ""
        error = float(grid["standard_error"][row, column])
        if there == seeds and math.isfinite(error):
            beneath = f"±{drawn(_two_figures(error))}"
        size = min(6.5, 36.0 / len(text))  # cells of four populations are narrow
        written = [
            axis.text(column + 0.5, row + (0.64 if beneath else 0.5), text, ha="center",
                      va="center", fontsize=size, color=ink),
            axis.text(column + 0.5, row + 0.27, beneath, ha="center", va="center",
                      fontsize=min(5.0, 28.0 / max(len(beneath), 1)), color=ink),
        ]  # fmt: skip
        if there < seeds:
            ground = COLOUR_MAP(scale(value)) if there else "white"
            for label in written:
                label.set_bbox({"facecolor": ground, "edgecolor": "none", "pad": 0.6})
            axis.add_patch(_frame(row, column, 0.0, hatch="////", edgecolor=ink, linewidth=0.8))
        if highest[row, column] and is_single:
            axis.add_patch(_frame(row, column, 0.045, edgecolor=ink, linewidth=1.5))
        elif grid["near_best"][row, column] and is_single:
            axis.add_patch(
                _frame(row, column, 0.045, edgecolor=ink, linewidth=0.5, linestyle=(0, (2, 1.5)))
            )


def _two_figures(error: float) -> str:
    """Write an error with two figures: 7.2e-5, 0.012, 1.7, 340."""
    if 0 < error < 0.001:
        mantissa, exponent = f"{error:.1e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    return f"{error:.2g}" if error < 100 else f"{error:.0f}"


def _frame(row: int, column: int, inset: float, *, linewidth: float = 0, **style: Any) -> Rectangle:
    corner, side = (column + inset, row + inset), 1 - 2 * inset
    return Rectangle(corner, side, side, fill=False, linewidth=linewidth, **style)
