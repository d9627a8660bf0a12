"""The paper's Figures 2 and 3, drawn from a table with a row for each generation of a run."""

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from neol.pictures.labels import drawn, method_label, task_label, three_figures
from neol.pictures.style import GREY, WIDTH, Style, drawing, footer, styles
from neol.study.outcomes.movement import NEAR_CONTROL_MARK, NEAR_CONTROL_NOTE
from neol.study.outcomes.statistics import Floats, mean_interval

MARKERS = 5
"""Marks on a line."""


def convergence(
    curves: pd.DataFrame,
    *,
    tasks: Sequence[str],
    methods: Sequence[str],
    seeds: Mapping[str, int],
    note: str,
    incomplete: Mapping[tuple[str, str], str],
    near_control: Collection[tuple[str, str]] = (),
    levels: Mapping[str, Mapping[str, tuple[float, float]]] = MappingProxyType({}),
) -> Figure:
    """Figures 2 and 3: best fitness over generations, and boxplots of the final one.

    One cell for each task and method; the lines are means over seeds with Student's 95% interval.
    `seeds` is the budget's number for each task. `incomplete` says for a task and method what its
    cell's choice lacked; such a method has a star, and the note gives the reason. Methods in
    `near_control` are marked too. `levels` of each task, from one value to another, are drawn
    behind its final values.
    """
    with drawing():
        figure = Figure(figsize=(WIDTH, 1.55 * WIDTH / max(len(tasks), 3) + 1.6))
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
                if table.shape[1] < seeds[task]:
                    reasons[task, method] = f"{table.shape[1]} of {seeds[task]} seeds"
                samples[method] = table.ffill().iloc[-1].to_numpy() if len(table) else np.array([])
                marked = (place + 0.5) / len(methods)
                draw_curve(top, method_label(method), looks[method], table.dropna(), marked)
            clip_to_runs(top, here["best_fitness"])
            marks = {
                method: "*" * ((task, method) in reasons)
                + NEAR_CONTROL_MARK * ((task, method) in near_control)
                for method in methods
            }
            _boxes(bottom, samples, looks, marks)
            _levels(bottom, levels.get(task, {}))
            top.set_xlabel("Generation")
            top.xaxis.set_major_locator(MaxNLocator(4, integer=True))
        axes[0, 0].set_ylabel("Best fitness (return)")
        axes[1, 0].set_ylabel("Final best fitness (return)")
        figure.align_ylabels(axes[:, 0])
        lines = {
            label: line
            for axis in axes[0]
            for line, label in zip(*axis.get_legend_handles_labels(), strict=True)
        }
        shown = [label for label in map(method_label, methods) if label in lines]
        figure.legend(
            [lines[label] for label in shown], shown, loc="outside upper center", ncols=len(methods)
        )
        explanation = (
            "Lines: means over seeds; bands: their 95% intervals, cut at the range of the runs. "
            "Boxes: quartiles, whiskers to 1.5 interquartile ranges; dots: single seeds."
        )
        if levels:
            explanation += (
                " Grey, or an arrow if outside the panel: Gymnasium's reward threshold, and the "
                "range of the means that the paper prints."
            )
        little = [NEAR_CONTROL_NOTE] if near_control else []
        footer(figure, "\n".join([f"{note} {explanation}", *little, *_listed(reasons)]))
    return figure


def draw_curve(axis: Axes, label: str, style: Style, table: pd.DataFrame, marked: float) -> None:
    """Draw a mean over seeds; `table` has a row for each generation, a column for each seed.

    `marked` says how far into each stretch of the line its marker is.
    """
    values = table.to_numpy(dtype=float)
    mean = values.mean(axis=1) if values.size else np.array([])
    axis.plot(
        table.index,
        mean,
        label=label if values.size else None,
        color=style.colour,
        linestyle=style.line,
        marker=style.marker,
        markevery=_spaced(len(mean), marked),
    )
    if values.size:
        low, high = np.clip(mean_interval(values), values.min(), values.max())
        axis.fill_between(table.index, low, high, color=style.colour, alpha=0.15, linewidth=0)


def clip_to_runs(axis: Axes, values: "pd.Series[float]") -> None:
    """Cut an axis at the range of its runs, which Student's bands exceed with few seeds."""
    if values.empty:
        return
    low, high = float(values.min()), float(values.max())
    margin = 0.03 * (high - low) or 0.01 * max(abs(high), 1.0)
    bottom, top = axis.get_ylim()
    axis.set_ylim(max(bottom, low - margin), min(top, high + margin))


def _spaced(points: int, offset: float) -> list[int]:
    """Return the positions of a line's markers, shifted so that those of methods do not overlap."""
    if points <= 2 * MARKERS:
        return list(range(points))
    step = points / MARKERS
    return [int(step * (marker + offset)) for marker in range(MARKERS)]


def _boxes(
    axis: Axes,
    samples: Mapping[str, Floats],
    looks: Mapping[str, Style],
    marks: Mapping[str, str],
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
    labels = [method_label(method).replace(" (", "\n(") + marks[method] for method in samples]
    axis.set_xticks(range(len(samples)), labels)
    axis.set_xlim(-0.6, len(samples) - 0.4)


def _levels(axis: Axes, levels: Mapping[str, tuple[float, float]]) -> None:
    """Draw levels behind the values, named above; a level beyond the panel has an arrow."""
    bottom, top = axis.get_ylim()
    axis.set_ylim(bottom, top)
    names = []
    for name, (low, high) in levels.items():
        arrow = "↑ " if low > top else "↓ " if high < bottom else ""
        if not arrow:
            axis.axhspan(low, high, color=GREY, alpha=0.25, linewidth=0.7, zorder=0)
        ends = dict.fromkeys(drawn(three_figures(level)) for level in (low, high))
        names.append(f"{arrow}{name} {' to '.join(ends)}")
    axis.set_title("\n".join(names), size=6, color=GREY)


def _tint(colour: str) -> tuple[float, float, float, float]:
    red, green, blue, _ = to_rgba(colour)
    return (0.3 * red + 0.7, 0.3 * green + 0.7, 0.3 * blue + 0.7, 1.0)


def _listed(reasons: Mapping[tuple[str, str], str]) -> list[str]:
    """List what is incomplete, by method and task, with reasons."""
    said = [
        f"{method_label(method)} on {task_label(task)}: {why}"
        for (task, method), why in reasons.items()
    ]
    return [f"* {'; '.join(said)}."] if said else []
