"""The paper's Figures 2 to 11, drawn from plain tables.

`runs` has a row for each run: task, method, population, learning_rate (NaN for a method without),
seed, and its outcomes. `curves` has a row for each generation of a run.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import seaborn
from matplotlib.axes import Axes
from matplotlib.colors import Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from neol.pictures.labels import drawn, method_label, task_label, three_figures
from neol.pictures.style import COLOUR_MAP, GREY, WIDTH, Style, drawing, footer, styles
from neol.study.outcomes.statistics import Floats, mean_interval


def convergence(
    curves: pd.DataFrame,
    *,
    tasks: Sequence[str],
    methods: Sequence[str],
    seeds: int,
    note: str,
    incomplete: Mapping[tuple[str, str], str],
) -> Figure:
    """Figures 2 and 3: best fitness over generations, and boxplots of the final one.

    One cell for each task and method; the lines are means over seeds with Student's 95% interval.
    `incomplete` says of a task and method what its cell's choice lacked; whoever lacks something
    has a star, and the note says what.
    """
    with drawing():
        figure = Figure(figsize=(WIDTH, 1.55 * WIDTH / max(len(tasks), 3) + 1.3))
        axes = figure.subplots(2, len(tasks), squeeze=False)
        reasons, looks = dict(incomplete), styles(methods)
        for column, task in enumerate(tasks):
            here = curves[curves["task"] == task]
            top, bottom = axes[:, column]
            top.set_title(task_label(task))
            samples = {}
            for place, method in enumerate(methods):
                table = here[here["method"] == method].pivot_table(
                    index="generation", columns="seed", values="best_fitness"
                )
                if table.shape[1] < seeds:
                    reasons[task, method] = f"{table.shape[1]} of {seeds} seeds"
                samples[method] = table.ffill().iloc[-1].to_numpy() if len(table) else np.array([])
                marked = (place + 0.5) / len(methods)
                draw_curve(top, method_label(method), looks[method], table.dropna(), marked)
            clip_to_runs(top, here["best_fitness"])
            starred = {method for where, method in reasons if where == task}
            _boxes(bottom, samples, looks, starred)
            top.set_xlabel("Generation")
            top.xaxis.set_major_locator(MaxNLocator(4, integer=True))
        axes[0, 0].set_ylabel("Best fitness (return)")
        axes[1, 0].set_ylabel("Final best fitness (return)")
        figure.align_ylabels(axes[:, 0])
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=len(methods))
        explanation = (
            "Lines: means over seeds, bands: their 95% intervals, cut at the range of the runs. "
            "Boxes: quartiles, whiskers to 1.5 interquartile ranges; dots: single seeds."
        )
        footer(figure, "\n".join([f"{note} {explanation}", *_listed(reasons)]))
    return figure


def heatmaps(
    runs: pd.DataFrame,
    *,
    metric: str,
    title: str,
    methods: Sequence[str],
    populations: Sequence[int],
    learning_rates: Sequence[float],
    seeds: int,
    note: str,
) -> Figure:
    """Figures 4 to 11: the mean of a task's `metric` over seeds for every population and rate.

    A method without a rate is a single row. All panels share one colour scale; a frame marks each
    method's highest mean. A cell that lacks seeds is hatched and says how many it has.
    """
    grids = {
        method: _grid(runs[runs["method"] == method], metric, populations, learning_rates)
        for method in methods
    }
    means = np.concatenate([mean.ravel() for mean, _ in grids.values()])
    scale = _scale(means[np.isfinite(means)])
    with drawing():
        figure = Figure(figsize=(WIDTH, 0.3 * len(learning_rates) + 1.3))
        figure.suptitle(title, x=0.01, ha="left")
        layout = figure.add_gridspec(len(learning_rates), len(methods))
        axes = []
        for position, method in enumerate(methods):
            mean, count = grids[method]
            axis = figure.add_subplot(layout[-len(mean) :, position])
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
            axis.invert_yaxis()
            axis.set_title(method_label(method)).set_in_layout(len(mean) > 1)
            axis.set_xlabel("Population size")
            axis.tick_params(length=0, rotation=0)
            _write_cells(axis, mean, count, seeds, scale)
            axes.append(axis)
        axes[0].set_ylabel("Learning rate")
        image = axes[0].collections[0]
        bar = figure.colorbar(image, ax=axes, fraction=0.02, pad=0.01, aspect=14)
        bar.outline.set_visible(False)
        bar.locator = MaxNLocator(4)
        lacking = sum(int((count < seeds).sum()) for _, count in grids.values())
        explanation = "Means over seeds; a frame marks a panel's highest, if it is one alone."
        warning = [f"Hatched: {lacking} of {means.size} cells lack seeds."] if lacking else []
        footer(figure, "\n".join([f"{note} {explanation}", *warning]))
    return figure


def draw_curve(axis: Axes, label: str, style: Style, table: pd.DataFrame, marked: float) -> None:
    """A method's mean over seeds; `table` has a row for each generation, a column for each seed.

    `marked` says how far into each stretch of the line its marker sits.
    """
    values = table.to_numpy(dtype=float)
    mean = values.mean(axis=1) if values.size else np.array([])
    axis.plot(
        table.index,
        mean,
        label=label,
        color=style.colour,
        linestyle=style.line,
        marker=style.marker,
        markevery=_spaced(len(mean), marked),
    )
    if values.size:
        low, high = mean_interval(values)
        axis.fill_between(table.index, low, high, color=style.colour, alpha=0.15, linewidth=0)


def clip_to_runs(axis: Axes, values: "pd.Series[float]") -> None:
    """Cut an axis at the range of its runs: Student's bands leave it where seeds are few."""
    if values.empty:
        return
    low, high = float(values.min()), float(values.max())
    margin = 0.03 * (high - low) or 0.01 * max(abs(high), 1.0)
    bottom, top = axis.get_ylim()
    axis.set_ylim(max(bottom, low - margin), min(top, high + margin))


def _spaced(points: int, offset: float, markers: int = 5) -> list[int]:
    """Where the markers of a line sit, apart from those of the other methods."""
    if points <= 2 * markers:
        return list(range(points))
    step = points / markers
    return [int(step * (marker + offset)) for marker in range(markers)]


def _boxes(
    axis: Axes,
    samples: Mapping[str, Floats],
    looks: Mapping[str, Style],
    starred: Collection[str],
) -> None:
    for position, (method, values) in enumerate(samples.items()):
        style = looks[method]
        if not len(values):
            axis.text(position, 0.5, "no runs", transform=axis.get_xaxis_transform(), rotation=90,
                      ha="center", va="center", color=GREY)  # fmt: skip
            continue
        axis.boxplot(
            values,
            positions=[position],
            widths=0.62,
            showfliers=False,
            patch_artist=True,
            boxprops={"facecolor": _tint(style.colour), "edgecolor": style.colour},
            medianprops={"color": "black", "linewidth": 1.3},
            whiskerprops={"color": style.colour},
            capprops={"color": style.colour},
        )
        spread = np.linspace(-0.22, 0.22, len(values)) if len(values) > 1 else np.zeros(1)
        axis.scatter(position + spread, values, s=6, marker=style.marker, facecolor=style.colour,
                     edgecolor="black", linewidth=0.25, alpha=0.85, zorder=3)  # fmt: skip
    labels = [
        method_label(method).replace(" (", "\n(") + ("*" if method in starred else "")
        for method in samples
    ]
    axis.set_xticks(range(len(samples)), labels)
    axis.set_xlim(-0.6, len(samples) - 0.4)


def _grid(
    runs: pd.DataFrame, metric: str, populations: Sequence[int], rates: Sequence[float]
) -> tuple[Floats, Floats]:
    """Mean and number of seeds: float64[rates, populations], one row where there is no rate."""
    rows = list(rates) if runs["learning_rate"].notna().any() else [0.0]
    by_cell = runs.assign(learning_rate=runs["learning_rate"].fillna(0.0)).groupby(
        ["learning_rate", "population"]
    )[metric]
    places = pd.MultiIndex.from_product([rows, populations])
    mean, count = by_cell.mean().reindex(places), by_cell.count().reindex(places, fill_value=0)
    shape = len(rows), len(populations)
    return (
        np.asarray(mean, dtype=np.float64).reshape(shape),
        np.asarray(count, dtype=np.float64).reshape(shape),
    )


def _scale(means: Floats) -> Normalize:
    """From the lowest to the highest mean, with some width even where all are equal."""
    if not len(means):
        return Normalize(0, 1)
    low, high = float(means.min()), float(means.max())
    margin = 0.005 * max(abs(low), abs(high), 1e-9) if np.isclose(low, high) else 0.0
    return Normalize(low - margin, high + margin)


def _write_cells(axis: Axes, mean: Floats, count: Floats, seeds: int, scale: Normalize) -> None:
    highest = mean == np.nanmax(mean) if np.isfinite(mean).any() else np.zeros(mean.shape, bool)
    for (row, column), value in np.ndenumerate(mean):
        there = int(count[row, column])
        ink = "white" if there and scale(value) < 0.55 else "black"
        text = drawn(three_figures(value)) if there else "no runs"
        if 0 < there < seeds:
            text += f"\n{there}/{seeds}"
        size = min(7.0, 39.0 / len(text.splitlines()[0]))  # a cell is narrow where there are four
        label = axis.text(column + 0.5, row + 0.5, text, ha="center", va="center",
                          fontsize=size, color=ink, linespacing=1)  # fmt: skip
        if there < seeds:
            ground = COLOUR_MAP(scale(value)) if there else "white"
            label.set_bbox({"facecolor": ground, "edgecolor": "none", "pad": 0.6})
            axis.add_patch(_frame(row, column, 0.0, hatch="////", edgecolor=ink, linewidth=0.8))
        if highest[row, column] and highest.sum() == 1:
            axis.add_patch(_frame(row, column, 0.035, edgecolor=ink, linewidth=1.1))


def _frame(row: int, column: int, inset: float, *, linewidth: float = 0, **style: Any) -> Rectangle:
    corner, side = (column + inset, row + inset), 1 - 2 * inset
    return Rectangle(corner, side, side, fill=False, linewidth=linewidth, **style)


def _tint(colour: str) -> tuple[float, float, float, float]:
    red, green, blue, _ = to_rgba(colour)
    return (0.3 * red + 0.7, 0.3 * green + 0.7, 0.3 * blue + 0.7, 1.0)


def _listed(reasons: Mapping[tuple[str, str], str]) -> list[str]:
    """What is incomplete: by task and method, why."""
    said = [
        f"{method_label(method)} on {task_label(task)}: {why}"
        for (task, method), why in reasons.items()
    ]
    return [f"* {'; '.join(said)}."] if said else []
