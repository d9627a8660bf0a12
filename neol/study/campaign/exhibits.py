"""Tasks and methods as the paper prints them, and in which order; and numbers."""

from neol.network.rules import WITHOUT_RULE
from neol.pictures.labels import METHOD_LABELS, TASK_LABELS
from neol.spec.constants import Budget

PAPER_RULES = ("bcm", "hebb", "oja")
"""In the order of its tables."""
HEATMAPS = {
    **{4 + position: (task, "final_best") for position, task in enumerate(TASK_LABELS)},
    **{8 + position: (task, "score") for position, task in enumerate(TASK_LABELS)},
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
    return (*PAPER_RULES, *(method for method in budget.methods if method not in METHOD_LABELS))


def shown_methods(budget: Budget) -> tuple[str, ...]:
    """All methods that tables and figures have a place for, in their order."""
    return (*challengers(budget), *WITHOUT_RULE)
