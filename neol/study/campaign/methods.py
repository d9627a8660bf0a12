"""The methods that tables and figures compare, and in which order."""

from neol.network.rules import WITHOUT_RULE
from neol.pictures.labels import METHOD_LABELS
from neol.spec.constants import Budget

PAPER_RULES = ("bcm", "hebb", "oja")
"""In the order of its tables."""


def challengers(budget: Budget) -> tuple[str, ...]:
    """What is compared with NEAT: the paper's rules, then a budget's other ones."""
    return (*PAPER_RULES, *(method for method in budget.methods if method not in METHOD_LABELS))


def shown_methods(budget: Budget) -> tuple[str, ...]:
    """All methods that tables and figures have a place for, in their order."""
    return (*challengers(budget), *WITHOUT_RULE)
