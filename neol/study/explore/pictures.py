"""Pictures that only notebooks/explore.ipynb shows."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from neol.base.errors import UserError
from neol.champions.player import Player, Trace
from neol.pictures.labels import drawn, method_label, task_label
from neol.pictures.style import GREY, WIDTH, drawing, footer, styles
from neol.run.record import DOCUMENTATION
from neol.study.explore.panel import load_record
from neol.study.figures.convergence import draw_curve
from neol.study.outcomes.statistics import Floats, mean_interval

PLASTIC, FROZEN = "#0072B2", "#D55E00"
"""Colours of an episode that learns to its end, and of one that stops learning."""

RUN_OUTCOMES = {
    "held_out": "Held-out return",
    "best_fitness": "Best fitness (return)",
    "connections": "Connections of the best genome",
    "env_steps": "Environment steps",
    "cpu_seconds": "CPU time (s)",
}
"""Outcomes by which runs can be compared: columns of `table_of_runs` and their axis labels."""


def axis_label(column: str) -> str:
    """Return the label of a record's column with its unit: "Best fitness (return)"."""
    unit = DOCUMENTATION[column][0]
    name = column.replace("_", " ").capitalize()
    return f"{name} ({unit})" if unit and unit != column else name


def run_settings(runs: pd.DataFrame, first: str) -> dict[str, tuple[str, int, float]]:
    """Return each budget, population and learning rate that has runs, by its label in a list.

    Those of the budget `first` are at its head.
    """
    columns = ["budget", "population", "learning_rate"]
    rows = runs[~runs["sensitivity"]].dropna(subset=columns)[columns].drop_duplicates()
    settings = sorted(
        rows.itertuples(index=False, name=None), key=lambda row: (row[0] != first, row)
    )
    return {
        f"{budget}: P = {population}, eta = {learning_rate:g}": (budget, population, learning_rate)
        for budget, population, learning_rate in settings
    }


def draw_learning_curves(
    results: Path,
    runs: pd.DataFrame,
    *,
    task: str,
    setting: tuple[str, int, float],
    column: str,
    against: str,
) -> Figure:
    """Draw one column of the records over another, for each method: mean with 95% interval.

    `setting` is a budget, a population and a learning rate, which NEAT ignores.
    Raises UserError if there is no such run.
    """
    budget, population, learning_rate = setting
    chosen = runs[
        (runs["task"] == task)
        & (runs["budget"] == budget)
        & (runs["population"] == population)
        & (runs["learning_rate"].isin([learning_rate]) | runs["learning_rate"].isna())
        & ~runs["sensitivity"]
    ]
    if chosen.empty:
        raise UserError(f"budget {budget} has no runs of {task} with P = {population}")
    looks = styles(sorted(runs["method"].unique()))
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.8))
        axis = figure.subplots()
        for method, records in chosen.groupby("method")["record"].unique().items():
            table = pd.concat([load_record(results / name).frame() for name in records])
            values = table.pivot_table(index="generation", columns="seed", values=column).dropna()
            x = table[against].groupby(table["generation"]).mean().loc[values.index]
            label = f"{method_label(str(method))}, {values.shape[1]} seeds"
            marked = (list(looks).index(str(method)) + 0.5) / len(looks)
            draw_curve(axis, label, looks[str(method)], values.set_axis(x), marked)
        axis.set_title(
            f"{task_label(task)}, budget {budget}, P = {population}, η = {learning_rate:g}"
        )
        axis.set_xlabel(axis_label(against))
        axis.set_ylabel(axis_label(column))
        figure.legend(loc="outside right upper")
    return figure


def switched_off(player: Player, *, step: int, episodes: int) -> Figure:
    """Draw the effect on held-out episodes of stopping plasticity after some steps.

    One episode with and without the stop: reward so far, and how far weights have moved. Then the
    returns of several episodes, each played both ways.
    """
    seeds = player.held_out_seeds[:episodes]
    plastic = [player.play(seed) for seed in seeds]
    frozen = [player.play(seed, plastic_steps=step) for seed in seeds]
    both = (("to the end", PLASTIC, "-", plastic), (f"to step {step}", FROZEN, "--", frozen))
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.7))
        reward, weight, returns = figure.subplots(1, 3)
        for label, colour, line, traces in both:
            reward.plot(np.cumsum(traces[0].rewards), line, color=colour, label=f"plastic {label}")
            weight.plot(_moved(traces[0]), line, color=colour)
        for axis in (reward, weight):
            axis.axvline(step, color=GREY, linewidth=0.7, linestyle=":")
            axis.set_xlabel("Step of one episode")
            axis.xaxis.set_major_locator(MaxNLocator(4, integer=True))
        reward.set_ylabel("Reward so far")
        weight.set_ylabel("Mean |weight − first weight|")
        _pairs(returns, plastic, frozen, step)
        figure.legend(loc="outside upper center", ncols=2)
        footer(figure, effect_of_learning(plastic, frozen, step))
    return figure


def effect_of_learning(plastic: Sequence[Trace], frozen: Sequence[Trace], step: int) -> str:
    """Say in a sentence what plasticity after a step did to a champion's return."""
    gains = [
        learned.episode_return - stopped.episode_return
        for learned, stopped in zip(plastic, frozen, strict=True)
    ]
    low, high = mean_interval(np.array(gains))
    interval = f"{np.mean(gains):+.1f} [{low:+.1f}, {high:+.1f}]"
    if not (low > 0 or high < 0):  # also where a single episode has no interval
        return (
            f"These {len(gains)} episodes do not show that plasticity after step {step} changes "
            f"this champion's return (mean change {interval})."
        )
    verb = "raises" if low > 0 else "lowers"
    return (
        f"In {len(gains)} episodes plasticity after step {step} {verb} this champion's return "
        f"(mean change {interval})."
    )


def draw_outcomes(runs: pd.DataFrame, *, task: str, budget: str, outcome: str, by: str) -> Figure:
    """Draw an outcome of a budget's runs of a task, grouped by a column: single runs and means.

    Runs of other budgets differ in length, or are the same runs again.
    Raises UserError if no run has both.
    """
    chosen = (runs["task"] == task) & (runs["budget"] == budget) & ~runs["sensitivity"]
    here = runs[chosen].dropna(subset=[outcome, by])
    if here.empty:
        raise UserError(f"budget {budget} has no run of {task} with {by} and {outcome}")
    with drawing():
        figure = Figure(figsize=(WIDTH, 2.8))
        axis = figure.subplots()
        groups = list(here.groupby(by)[outcome])
        for place, (_, values) in enumerate(groups):
            sample = values.to_numpy(dtype=float)
            offsets = np.linspace(-0.18, 0.18, len(sample))
            axis.plot(place + offsets, sample, ".", color=GREY, alpha=0.5, markersize=3)
            low, high = mean_interval(sample)
            axis.vlines(place + 0.3, low, high, color=PLASTIC)
            axis.plot(place + 0.3, sample.mean(), "o", color=PLASTIC)
        names = [method_label(str(key)) if by == "method" else f"{key:g}" for key, _ in groups]
        counts = [len(values) for _, values in groups]
        axis.set_xticks(
            range(len(groups)), [f"{name}\n{n} runs" for name, n in zip(names, counts, strict=True)]
        )
        axis.set_title(f"{task_label(task)}, budget {budget}")
        axis.set_xlabel(by.replace("_", " ").capitalize())
        axis.set_ylabel(RUN_OUTCOMES[outcome])
    return figure


def _moved(trace: Trace) -> Floats:
    """Return the mean distance of the weights from their initial values, after each step."""
    moved: Floats = np.abs(trace.weights - trace.weights[0]).mean(axis=1)
    return moved


def _pairs(axis: Axes, plastic: Sequence[Trace], frozen: Sequence[Trace], step: int) -> None:
    """Draw each episode's two returns against each other, and their mean difference."""
    x = np.array([trace.episode_return for trace in plastic])
    y = np.array([trace.episode_return for trace in frozen])
    axis.axline((0, 0), slope=1, color=GREY, linewidth=0.7, linestyle=":")
    axis.plot(x, y, "o", color=FROZEN, alpha=0.7)
    axis.set_xlabel("Return, plastic to the end")
    axis.set_ylabel(f"Return, plastic to step {step}")
    low, high = mean_interval(y - x)
    gain = f"Stopping gains {np.mean(y - x):+.1f}\n(95%: {low:+.1f} to {high:+.1f})"
    axis.set_title(drawn(gain))
