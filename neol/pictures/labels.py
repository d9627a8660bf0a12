"""Labels of tasks, methods and numbers."""

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
    """Return the paper's label of a method, or a label made from its name."""
    return METHOD_LABELS.get(method, method.replace("_", " "))


def task_label(task: str) -> str:
    """Return the paper's label of a task, or a label made from its name."""
    if task.startswith("gym:"):
        return task.removeprefix("gym:")
    return TASK_LABELS.get(task, task.replace("_", " ").title())


def listed(words: Iterable[str]) -> str:
    """Join words as in "BCM, Hebb and Oja"; empty for none."""
    *others, last = [*words] or [""]
    return f"{', '.join(others)} and {last}" if others else last


def three_figures(value: float) -> str:
    """Format a number with three significant figures, or as an integer: 0.451, 12.0, 1234."""
    if math.isnan(value):
        return "--"
    text = f"{value:.0f}" if abs(value) >= 100 else f"{value + 0.0:#.3g}"  # + 0.0: no "-0"
    return text.rstrip(".")


def with_interval(value: float, low: float, high: float) -> str:
    """Format a value with its interval: 9.00 [0.500, 17.5]; "--" if there is no value."""
    if math.isnan(value):
        return "--"
    return f"{three_figures(value)} [{three_figures(low)}, {three_figures(high)}]"


def value_range(values: Iterable[float]) -> str:
    """Format the range of values as integers: 195 to 398, or 500 if all round to it."""
    rounded = [round(float(value)) for value in values]
    low, high = min(rounded), max(rounded)
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


def drawn(number: str) -> str:
    """Typeset a number for pictures: its hyphens become a dash and a minus sign."""
    return number.replace("--", "–").replace("-", "−")
