"""The verdict on a question, by rules that paper/plan.md explains.

The first of these that applies:

1. holds by construction: the answer follows from a definition.
2. not asked here: a cell is missing, or has fewer seeds than the first look takes.
3. too short: fewer generations than the paper's, unless the question is about a maximum that runs
   have reached.
4. mixed: the whole is decided, and a part significantly points the other way.
5. reproduced: distinguishable from 0 in the direction that the paper claims, after Holm's
   correction, and inside the interval that the paper's numbers predict.
6. same direction: distinguishable from 0 in that direction, but outside that interval.
7. not reproduced: distinguishable from 0 in the other direction.
8. equivalent to zero: the interval of two one-sided tests lies within the margin.
9. not reproduced: outside the interval that the paper's numbers predict, and on the side of 0;
   or significantly smaller than the effect that the paper's 30 seeds detect one time in three.
10. inconclusive: none of these.

Where the paper claims no difference, or no disadvantage, it is reproduced if the interval of the
one-sided tests lies within the margin, and not reproduced if it lies wholly beyond. Where the
parts have rules of their own, it is reproduced if all are for, and not if one is against.
"""

from collections.abc import Collection
from typing import Literal

from neol.study.claims.effect import Effect
from neol.study.claims.evidence import Evidence
from neol.study.claims.parts import State
from neol.study.claims.questions import Difference, Expect, Interaction, Question, Sensitivity
from neol.study.outcomes.statistics import ALPHA

Verdict = Literal[
    "reproduced",
    "same direction",
    "mixed",
    "not reproduced",
    "equivalent to zero",
    "inconclusive",
    "too short",
    "not asked here",
    "holds by construction",
]
FOR: tuple[Verdict, ...] = ("reproduced", "same direction")
"""Verdicts for the paper; "mixed" is for it in part."""
AGAINST: tuple[Verdict, ...] = ("not reproduced", "equivalent to zero")
OPPOSITE = "the other direction"
"""Reason of a verdict "not reproduced" where our effect is distinguishable from 0."""
UNASKED: tuple[Verdict, ...] = ("too short", "not asked here")
"""Verdicts of questions that a budget is too small for."""


def expects(question: Question) -> Expect | None:
    """Return the paper's expectation of an effect; None where parts have their own rules."""
    if isinstance(question, Difference | Interaction | Sensitivity):
        return question.expect
    return None


def state_of(ours: Effect, expect: Expect | None, margin: float, alpha: float) -> State:
    """Return on which side of 0, or of the margin, the interval lies."""
    low, high = ours.interval(1 - alpha)
    if expect == "equal":
        within = _within(ours, margin, alpha)
        beyond = low > margin or high < -margin
    elif expect == "not_lower":
        within, beyond = ours.interval(1 - 2 * alpha)[0] > -margin, high < -margin
    else:
        within, beyond = (low > 0, high < 0) if expect == "higher" else (high < 0, low > 0)
    return "for" if within else "against" if beyond else "open"


def _within(ours: Effect, margin: float, alpha: float) -> bool:
    """Return whether two one-sided tests place the effect within the margin (Schuirmann 1987)."""
    low, high = ours.interval(1 - 2 * alpha)
    return -margin < low and high < margin


def judge(
    question: Question,
    states: Collection[State | None],
    whole: Evidence | None,
    p_holm: float,
    alpha: float,
) -> tuple[Verdict, str]:
    """Return the verdict, and a reason, on runs that are long and many enough.

    `states` are the states of the parts, `p_holm` is the corrected p-value of the whole, `alpha`
    the level of the look.
    """
    if whole is None:
        if "against" in states:
            return "not reproduced", "a part is against"
        return ("reproduced", "") if set(states) == {"for"} else ("inconclusive", "")
    if whole.state:
        return _OF_STATE[whole.state], ""
    ours = whole.ours
    if ours is None:
        return "inconclusive", "nothing varies"
    expect = expects(question)
    if expect in ("equal", "not_lower"):
        state = state_of(ours, expect, whole.margin, alpha)
        if state == "for" and "against" in states:
            return "mixed", "a part points the other way"
        return _OF_STATE[state], ""
    return _of_difference(ours, whole.paper, expect == "lower", whole.margin, p_holm, alpha, states)


_OF_STATE: dict[State, Verdict] = {
    "for": "reproduced",
    "against": "not reproduced",
    "open": "inconclusive",
}


def _of_difference(
    ours: Effect,
    paper: Effect | None,
    lower: bool,
    margin: float,
    p_holm: float,
    alpha: float,
    states: Collection[State | None],
) -> tuple[Verdict, str]:
    """Return the verdict where the paper claims a difference from 0."""
    sign = -1 if lower else 1
    predicted = paper is None or paper.predicts(ours, alpha)
    if p_holm < ALPHA and sign * ours.value > 0:
        if "against" in states:
            return "mixed", "a part points the other way"
        return ("reproduced", "") if predicted else ("same direction", "not of the paper's size")
    if p_holm < ALPHA:
        return "not reproduced", OPPOSITE
    if _within(ours, margin, alpha):
        return "equivalent to zero", ""
    if paper is None:
        return "inconclusive", ""
    if not predicted and sign * (paper.value - ours.value) > 0:
        return "not reproduced", "outside what the paper's numbers predict"
    low, high = ours.interval(1 - 2 * alpha)
    if (-low if lower else high) < paper.telescope:
        return "not reproduced", "smaller than the paper's seeds could have seen"
    return "inconclusive", ""
