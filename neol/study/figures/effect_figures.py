"""Pictures of the tables of `effects` and `sensitivity`: what the paper does not show."""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator
from matplotlib.transforms import blended_transform_factory

from neol.pictures.labels import method_label, task_label
from neol.pictures.style import GREY, WIDTH, Style, drawing, footer, styles
from neol.spec.constants import Budget
from neol.study.campaign.methods import shown_methods
from neol.study.campaign.variants import BASELINE
from neol.study.outcomes.effects import COMPARISONS, thresholds
from neol.study.outcomes.outcomes import EQUAL

GROUND = {"facecolor": "white", "edgecolor": "none", "pad": 0.4}
"""Behind words that lines run through."""
NO_LINE = (
    "A mark without a line: all runs tie, or all of one side are higher, and so are all resamples; "
    "that does not make it certain."
)
METRIC_LABELS = {
    "score": "SCORE",
    "equal_evaluations": "Best return so far,\nequal evaluations",
    "equal_steps": "Best return so far,\nequal steps",
}


def draw_effect_sizes(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """A12 of each method with its interval; a cross is the paper's, from its p-value."""
    looks = styles(shown_methods(budget))
    places: dict[tuple[str, str, str], float] = {}
    tops = []
    for comparison in COMPARISONS:
        tops.append(min(places.values(), default=0.8) - 1.8)
        places |= {
            (comparison.outcome, comparison.against, method): tops[-1] - position
            for position, method in enumerate(comparison.methods(budget))
        }
    bottom = min(places.values())
    with drawing():
        columns = [*budget.tasks, "all"]
        figure = Figure(figsize=(WIDTH, 1.1 - 0.13 * bottom))
        axes = figure.subplots(1, len(columns), sharey=True, sharex=True)
        for axis, task in zip(axes, columns, strict=True):
            _from_0_to_1(axis, "All tasks" if task == "all" else task_label(task))
            for row in table[table["task"] == task].to_dict("records"):
                place = places[row["outcome"], row["against"], row["method"]]
                _interval(axis, place, row, "a12", looks[row["method"]])
                axis.plot(row["paper_a12"], place, "x", color="black", markersize=4)
        axes[0].set_yticks(list(places.values()), [method_label(each) for *_, each in places])
        from_the_left = blended_transform_factory(figure.transFigure, axes[0].transData)
        for comparison, top in zip(COMPARISONS, tops, strict=True):
            text = f"{comparison.outcome} vs {method_label(comparison.against)}"
            text = f"{text[0].upper()}{text[1:]}"
            label = axes[0].text(
                0.008, top + 0.62, text, size=7, color=GREY, bbox=GROUND, transform=from_the_left
            )
            label.set_in_layout(False)
        axes[0].set_ylim(bottom - 0.5, tops[0] + 1.2)
        _below(axes, "Probability that a run of the method ends higher (A12)")
        explanation = (
            "Lines: 95% intervals (stratified bootstrap); crosses: the paper's, from its p-values."
        )
        if (table["low"] == table["high"]).any():
            explanation += f" {NO_LINE}"
        footer(figure, f"{note} {explanation}")
    return figure


def draw_profiles(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Performance profiles over all tasks."""
    looks = _looks(table, budget)
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
    """Interquartile means of each task and of all."""
    looks, methods = _looks(table, budget), list(_looks(table, budget))
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
        explanation = "Lines: 95% intervals (stratified bootstrap), some within their mark."
        footer(figure, f"{note} {explanation}{_no_threshold(budget)}")
    return figure


def draw_efficiency(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """SCORE beside the best-so-far fitness at equal cost, over the population size."""
    looks = _looks(table, budget)
    with drawing():
        figure = Figure(figsize=(WIDTH, 5.2))
        axes = figure.subplots(len(METRIC_LABELS), len(budget.tasks), sharex=True, squeeze=False)
        for row, (metric, label) in zip(axes, METRIC_LABELS.items(), strict=True):
            for axis, task in zip(row, budget.tasks, strict=True):
                here = table[(table["metric"] == metric) & (table["task"] == task)]
                _by_population(axis, here, looks)
            row[0].set_ylabel(label)
        for column, task in enumerate(budget.tasks):
            axes[0, column].set_title(task_label(task))
            axes[-1, column].set_xlabel("Population size")
        figure.align_ylabels(axes[:, 0])
        _legend(figure, looks)
        explanation = "Means over learning rates, then seeds, with 95% intervals. Equal cost: "
        footer(figure, f"{note} {explanation}{'; '.join(_ranges(table, budget))}.")
    return figure


def draw_selection_bias(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Final best fitness minus the champion's mean return in fresh episodes."""
    looks = _looks(table, budget)
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


def draw_sensitivity(table: pd.DataFrame, budget: Budget, seeds: int, note: str) -> Figure:
    """How often a variant beats the baseline's run of a seed, with interval; a column for a task.

    A trial that lacks some of its `seeds`, or pairs with the baseline, says how many it has.
    """
    looks = _looks(table, budget)
    names = [name for name in dict.fromkeys(table["variant"]) if name != BASELINE]
    varied = table[table["variant"] != BASELINE]
    with drawing():
        figure = Figure(figsize=(WIDTH, 0.27 * len(names) + 1.1))
        tasks = list(dict.fromkeys(table["task"]))
        axes = figure.subplots(1, len(tasks), sharey=True, sharex=True, squeeze=False)[0]
        for axis, task in zip(axes, tasks, strict=True):
            _from_0_to_1(axis, task_label(task))
            here = varied[varied["task"] == task]
            counts = here.groupby("variant")["method"].transform("size")
            for row in here.assign(beside=counts > 1).to_dict("records"):
                offset = 0.2 * row["beside"] * (-1 if row["method"] == "neat" else 1)
                place = offset - names.index(row["variant"])
                _interval(axis, place, row, "a12", looks[row["method"]])
                if row["pairs"] < seeds:
                    there = f"{row['pairs']}/{seeds}"
                    axis.text(0, place, there, size=5.5, va="center", color=GREY, bbox=GROUND)
        axes[0].set_yticks([-position for position in range(len(names))], names)
        axes[0].set_ylim(-len(names) + 0.4, 0.6)
        _below(axes, "Share of seeds whose champion is above the baseline's in fresh episodes")
        _legend(figure, looks)
        lines = [f"{note} Lines: 95% intervals (bootstrap)."]
        if (varied["low"] == varied["high"]).any():
            lines[0] += f" {NO_LINE}"
        lacking = int((table["seeds"] < seeds).sum())
        if lacking:
            lines.append(f"Seeds are missing: {lacking} of {len(table)} trials are incomplete.")
        failed = int(table["without_value"].sum())
        if failed:
            lines.append(f"Left out: {failed} runs whose champion failed in all fresh episodes.")
        footer(figure, "\n".join(lines))
    return figure


def _by_population(axis: Axes, table: pd.DataFrame, looks: Mapping[str, Style]) -> None:
    """A method's mean over the population size, with intervals; methods side by side."""
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
    """Between which evaluations and steps the means at equal cost are taken, by task."""
    for task in budget.tasks:
        ranges = []
        for metric, column in EQUAL.items():
            here = table[(table["task"] == task) & (table["metric"] == metric)]
            first, last = here["first"].min(), here["last"].min()
            if first < last:
                name = column.replace("env_steps", "steps")
                ranges.append(f"{first:,.0f} to {last:,.0f} {name}")
        yield f"{task_label(task)}, {' and '.join(ranges) or 'no common range'}"


def _no_threshold(budget: Budget) -> str:
    """Which tasks cannot be put together with others."""
    without = [task_label(task) for task in budget.tasks if task not in thresholds()]
    return f" Left out, having no threshold: {', '.join(without)}." if without else ""


def _from_0_to_1(axis: Axes, title: str) -> None:
    """An axis of shares, with its middle marked."""
    axis.axvline(0.5, color=GREY, linewidth=0.7)
    axis.set_title(title)
    axis.set_xlim(-0.04, 1.04)
    axis.xaxis.set_major_locator(FixedLocator([0, 0.5, 1]))
    axis.tick_params(axis="y", length=0)


def _below(axes: Sequence[Axes], label: str) -> None:
    """One label for a row of axes, in its middle."""
    even = len(axes) % 2 == 0
    axes[len(axes) // 2].set_xlabel(label, x=-0.02 if even else 0.5)


def _legend(figure: Figure, looks: Mapping[str, Style]) -> None:
    """A figure's methods."""
    handles = [
        Line2D([], [], color=style.colour, linestyle=style.line, marker=style.marker)
        for style in looks.values()
    ]
    labels = [method_label(method) for method in looks]
    figure.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), 6))


def _looks(table: pd.DataFrame, budget: Budget) -> dict[str, Style]:
    """How the methods that a table has are drawn, in the order of every figure."""
    there = set(table["method"])
    looks = styles(shown_methods(budget))
    return {method: style for method, style in looks.items() if method in there}


def _interval(
    axis: Axes, place: float, row: Mapping[Hashable, Any], value: str, style: Style
) -> None:
    axis.hlines(place, row["low"], row["high"], color=style.colour, linewidth=1.3)
    axis.plot(row[value], place, style.marker, color=style.colour, markersize=4)
