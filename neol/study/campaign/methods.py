"""The methods that tables and figures compare, and their order."""

from neol.network.rules import BASELINES, MUTATED
from neol.pictures.labels import METHOD_LABELS
from neol.spec.constants import Budget

PAPER_RULES = ("bcm", "hebb", "oja")
"""The paper's rules in the order of its tables."""


def challengers(budget: Budget) -> tuple[str, ...]:
    """Return the methods that are compared with NEAT: the paper's rules, then other ones."""
    return (*PAPER_RULES, *(method for method in budget.methods if method not in METHOD_LABELS))


def shown_methods(budget: Budget) -> tuple[str, ...]:
    """Return all methods that tables and figures show, in their order."""
    return (*challengers(budget), *BASELINES)


def mutated(rule: str) -> str:
    """Return the method of a rule with weight mutation: the fourth cell of the two-by-two."""
    return rule + MUTATED


def without_mutation(method: str) -> str:
    """Return the rule of a method with weight mutation; any other method unchanged."""
    return method.removesuffix(MUTATED)
