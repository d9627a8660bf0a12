"""How tasks, methods and numbers are printed."""

import math
from collections.abc import Iterable

METHOD_LABELS = {
    "bcm": "BCM",
    "hebb": "Hebb",
    "oja": "Oja",
    "neat": "NEAT",
    "neat_wo": "NEAT (w/o)",
}


TASK_LABELS = {
    "cartpole": "CartPole",
    "lunar_lander": "Lunar Lander",
    "hopper": "Hopper",
    "bipedal_walker": "Bipedal Walker",
}


def method_label(method: str) -> str:
    """A method's name; of one that the paper does not have, its own."""
    return METHOD_LABELS.get(method, method.replace("_", " "))


def task_label(task: str) -> str:
    """A task's name; of one that the paper does not have, its own."""
    if task.startswith("gym:"):
        return task.removeprefix("gym:")
    return TASK_LABELS.get(task, task.replace("_", " ").title())


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
