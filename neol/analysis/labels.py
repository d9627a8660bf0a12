"""Tasks and methods as the paper prints them, and in which order; and numbers."""

import math
from collections.abc import Iterable

from neol.constants import Budget
from neol.rules import WITHOUT_RULE

METHODS = {"bcm": "BCM", "hebb": "Hebb", "oja": "Oja", "neat": "NEAT", "neat_wo": "NEAT (w/o)"}
PAPER_RULES = ("bcm", "hebb", "oja")
"""In the order of its tables."""
TASKS = {
    "cartpole": "CartPole",
    "lunar_lander": "Lunar Lander",
    "hopper": "Hopper",
    "bipedal_walker": "Bipedal Walker",
}
HEATMAPS = {
    **{4 + position: (task, "final_best") for position, task in enumerate(TASKS)},
    **{8 + position: (task, "score") for position, task in enumerate(TASKS)},
}
"""The paper's Figures 4 to 11: task and outcome of each."""
BEYOND = (
    "beyond_effects",
    "beyond_aggregates",
    "beyond_profiles",
    "beyond_efficiency",
    "beyond_selection",
    "beyond_sensitivity",
)
"""The figures that the paper does not have."""


def heatmaps_of(budget: Budget) -> list[int]:
    """The numbers of the heat maps whose tasks a budget has."""
    return [number for number, (task, _) in HEATMAPS.items() if task in budget.tasks]


def challengers(budget: Budget) -> tuple[str, ...]:
    """What is compared with NEAT: the paper's rules, then a budget's other ones."""
    return (*PAPER_RULES, *(method for method in budget.methods if method not in METHODS))


def shown_methods(budget: Budget) -> tuple[str, ...]:
    """All methods that tables and figures have a place for, in their order."""
    return (*challengers(budget), *WITHOUT_RULE)


def method_label(method: str) -> str:
    """A method's name; of one that the paper does not have, its own."""
    return METHODS.get(method, method.replace("_", " "))


def task_label(task: str) -> str:
    """A task's name; of one that the paper does not have, its own."""
    if task.startswith("gym:"):
        return task.removeprefix("gym:")
    return TASKS.get(task, task.replace("_", " ").title())


def listed(words: Iterable[str]) -> str:
    """BCM, Hebb and Oja"""
    *others, last = words
    return f"{', '.join(others)} and {last}" if others else last


def three_figures(value: float) -> str:
    """0.451, 12.0, 1234: three significant figures, of large numbers all before the point."""
    if math.isnan(value):
        return "--"
    text = f"{value:.0f}" if abs(value) >= 100 else f"{value + 0.0:#.3g}"  # + 0.0: no "-0"
    return text.rstrip(".")


def drawn(number: str) -> str:
    """A number as pictures show it: with a dash and a minus for its hyphens."""
    return number.replace("--", "–").replace("-", "−")
