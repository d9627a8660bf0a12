"""Each rule minus a baseline over generations, with intervals of the difference itself.

Bands of two means that overlap do not show that the means are equal; a band of their difference
that includes 0 says directly that these seeds do not distinguish them.
"""

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from neol.network.rules import BASELINES
from neol.pictures.labels import listed, method_label, task_label
from neol.pictures.style import GREY, WIDTH, drawing, footer
from neol.spec.constants import Budget
from neol.study.figures.figure import looks_of
from neol.study.outcomes.contrasts import Moments, difference


def differences_over_generations(curves: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each task, rule and generation: the difference and its 95% interval.

    `curves` has columns task, method, seed, generation and best_fitness, and one baseline.
    """
    rows = []
    for task, here in curves.groupby("task", sort=False):
        samples = {
            method: runs.pivot_table(index="generation", columns="seed", values="best_fitness")
            for method, runs in here.groupby("method", sort=False)
        }
        against = [method for method in BASELINES if method in samples]
        for method in (each for each in samples if against and each not in BASELINES):
            baseline = samples[against[0]]
            for generation in samples[method].index.intersection(baseline.index):
                both = (samples[method], baseline)
                ours, theirs = (Moments.of(each.loc[generation].dropna()) for each in both)
                found = difference(ours, theirs)
                low, high = found.interval()
                rows.append((task, method, against[0], generation, found.value, low, high))
    columns = ["task", "method", "against", "generation", "difference", "low", "high"]
    return pd.DataFrame(rows, columns=columns)


def draw_difference_curves(table: pd.DataFrame, budget: Budget, note: str) -> Figure:
    """Draw `differences_over_generations`: a panel for each task, a line for each rule."""
    looks = looks_of(table, budget)
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.9))
        panels = figure.subplots(1, len(budget.tasks), squeeze=False)[0]
        for axis, task in zip(panels, budget.tasks, strict=True):
            axis.axhline(0, color=GREY, linewidth=0.7)
            for method, look in looks.items():
                line = table[(table["task"] == task) & (table["method"] == method)]
                axis.plot(
                    line["generation"], line["difference"], color=look.colour, linestyle=look.line,
                    label=method_label(method),
                )  # fmt: skip
                axis.fill_between(
                    line["generation"], line["low"], line["high"], color=look.colour, alpha=0.15,
                    linewidth=0,
                )  # fmt: skip
            axis.set_title(task_label(task))
            axis.set_xlabel("Generation")
            axis.xaxis.set_major_locator(MaxNLocator(4, integer=True))
        against = listed(method_label(each) for each in dict.fromkeys(table["against"]))
        panels[0].set_ylabel(f"Best fitness, minus {against}'s")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=max(len(labels), 1))
        footer(
            figure,
            f"{note} Bands: Welch's 95% intervals of the difference of means, one generation at a "
            "time; where a band includes 0, these seeds do not distinguish the two methods.",
        )
    return figure


def describe_curves(table: pd.DataFrame) -> list[str]:
    """Say for each task and rule in how many generations the difference is distinguishable."""
    sentences = []
    for task, here in table.groupby("task", sort=False):
        said = []
        for method, line in here.groupby("method", sort=False):
            higher, lower = (line["low"] > 0).mean(), (line["high"] < 0).mean()
            shares = [
                f"{share:.0%} of generations {side}"
                for share, side in ((higher, "higher"), (lower, "lower"))
                if share > 0
            ]
            said.append(f"{method_label(str(method))} {' and '.join(shares) or 'in none'}")
        against = method_label(str(here["against"].iloc[0]))
        sentences.append(
            f"{task_label(str(task))}, distinguishable from {against}: {listed(said)}."
        )
    return sentences
