"""Units of a question's effects, and effects as pages print them."""

import math

from neol.pictures.labels import with_interval
from neol.study.claims.questions import Difference, Interaction, Question

_OUTCOMES = {"final_best": "return", "score": "SCORE", "held_out": "return"}
_SCALES = {"sd": "SDs of a run", "relative": "share of the baseline's mean"}


def unit_of(question: Question) -> str:
    """Return the unit of a question's effects in print; empty for a question without effects."""
    if isinstance(question, Interaction):
        return _SCALES["sd"]
    if not isinstance(question, Difference):
        return ""
    if question.statistic == "spread":
        return "ratio of SDs"
    return _SCALES.get(question.scale) or _OUTCOMES.get(question.outcome, "")


def in_print(question: Question, *values: float) -> tuple[float, ...]:
    """Return effects in the unit of print: spread, a logarithm, becomes a ratio of SDs."""
    if isinstance(question, Difference) and question.statistic == "spread":
        return tuple(math.exp(value) for value in values)
    return values


def interval_in_print(question: Question, value: float, low: float, high: float) -> str:
    """Format an effect with its interval, in the unit of print; "--" if there is none."""
    return with_interval(*in_print(question, value, low, high))
