"""The verdict on a question, by rules that paper/plan.md explains.

The first of these that applies:

1. holds by construction: the answer follows from a definition.
2. not asked here: a cell is missing, or has fewer seeds than the first look takes.
3. too short: fewer generations than the paper's. (Not for a maximum that is reached already.)
4. mixed: the whole is decided, and a part surely points the other way.
5. reproduced: distinguishable from 0 in the direction that the paper claims, after Holm's
   correction, and inside the interval that the paper's numbers predict.
6. same direction: the same, but outside that interval.
7. not reproduced: distinguishable from 0 in the other direction.
8. equivalent to zero: the interval of two one-sided tests lies within the margin.
9. not reproduced: outside the interval that the paper's numbers predict, and on the side of 0;
   or surely smaller than what the paper's 30 seeds would have found one time in three.
10. inconclusive.

Where the paper claims that there is no difference, or no disadvantage, the interval of the
one-sided tests within the margin reproduces it, one wholly beyond the margin does not. Where the
parts have rules of their own, all must be for, and one against is enough.
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from scipy import stats

from neol.study.claims.effect import Effect
from neol.study.claims.evidence import Evidence, State, evidence, leading
from neol.study.claims.looks import LOOKS, level, look, overall_p
from neol.study.claims.questions import Difference, Expect, Interaction, Question, Sensitivity
from neol.study.claims.sides import Runs
from neol.study.outcomes.outcomes import Outcomes
from neol.study.outcomes.score import PAPER_GENERATIONS
from neol.study.outcomes.statistics import ALPHA, holm

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
POWER = 0.8


@dataclass(frozen=True, slots=True)
class Finding:
    """What is known of one part of a question, or of the whole."""

    evidence: Evidence
    state: State | None
    """For, against or open at this look; None without an effect."""
    low: float
    high: float
    """The interval at this look's level."""
    near_control: bool = False
    """Whether its rules move next to nothing, so that it is no effect of learning."""


@dataclass(frozen=True, slots=True)
class Answer:
    """A question, and what runs say to it."""

    question: Question
    verdict: Verdict
    reason: str
    parts: tuple[Finding, ...]
    whole: Finding | None
    seeds: int
    """Of each method: those of the last look that is complete."""
    p: float
    """Of the whole: two-sided, all looks paid for; NaN where 0 is not tested."""
    p_holm: float
    """The same, corrected over the question's family."""
    compatible: bool | None
    """Whether ours lies where the paper's numbers predict it; None without such numbers."""
    papers: Verdict | None
    """The verdict on the paper's own numbers; None where it prints none."""
    seeds_needed: float
    """With which the paper's effect would be distinguishable 4 times of 5; NaN if unknown."""
    fresh: Effect | None
    """The whole from seeds 10 on alone, which nobody had seen at a smaller budget."""

    @property
    def counts(self) -> dict[State, int]:
        """Parts for, against and open."""
        found = Counter(part.state or "open" for part in self.parts)
        return {"for": found["for"], "against": found["against"], "open": found["open"]}

    @property
    def near_control(self) -> bool:
        """Whether every part is, of which some have a rule: then no rule has done anything."""
        rules = [
            part.near_control
            for part in self.parts
            if any(cell.learning_rate is not None for cell in part.evidence.cells)
        ]
        return bool(rules) and all(rules)


@dataclass(frozen=True, slots=True)
class _Asked:
    """A question with its evidence, before its family is known."""

    question: Question
    parts: tuple[Evidence, ...]
    whole: Evidence | None
    seeds: int
    number: int | None
    """Of the look."""
    fresh: Effect | None


def answers(questions: Sequence[Question], outcomes: Outcomes) -> tuple[Answer, ...]:
    """The answers to all questions; Holm's correction needs them together."""
    asked = [_ask(question, outcomes) for question in questions]
    ours = _corrected(
        questions,
        [_effect(each.whole, "ours") if each.number is not None else None for each in asked],
        [each.number or 0 for each in asked],
        unanswered=1.0,
    )
    papers = _corrected(
        questions,
        [_effect(each.whole, "paper") for each in asked],
        [len(LOOKS) - 1] * len(asked),
        unanswered=math.nan,
    )
    return tuple(
        _answer(each, outcomes, *found, papers_p)
        for each, found, (_, papers_p) in zip(asked, ours, papers, strict=True)
    )


def _ask(question: Question, outcomes: Outcomes) -> _Asked:
    """Collect the evidence at the last look for which all cells that have runs have the seeds."""
    named = evidence(question, Runs(outcomes, 0, 0), ALPHA)
    cells = [cell for part in named.parts for cell in part.cells]
    seeds = min((count for count in map(outcomes.leading, cells) if count), default=0)
    number = look(seeds)
    end = seeds if number is None else LOOKS[number]
    found = evidence(question, Runs(outcomes, 0, end), ALPHA if number is None else level(number))
    fresh = None
    if end > LOOKS[0]:
        fresh = _effect(evidence(question, Runs(outcomes, LOOKS[0], end), ALPHA).whole, "ours")
    return _Asked(question, found.parts, found.whole, end, number, fresh)


def _effect(whole: Evidence | None, name: Literal["ours", "paper"]) -> Effect | None:
    return None if whole is None else getattr(whole, name)


def _corrected(
    questions: Sequence[Question],
    effects: Sequence[Effect | None],
    looks: Sequence[int],
    unanswered: float,
) -> list[tuple[float, float]]:
    """Repeated p-values, and Holm's over each family.

    `unanswered` is the p-value with which a question without an effect counts in its family; NaN
    if it does not count.
    """
    p = [
        math.nan if effect is None or not _tests_zero(question) else overall_p(effect.p(), number)
        for question, effect, number in zip(questions, effects, looks, strict=True)
    ]
    adjusted = [math.nan] * len(p)
    for family in {question.family for question in questions}:
        places = [place for place, each in enumerate(questions) if each.family == family]
        corrected = holm([unanswered if math.isnan(p[place]) else p[place] for place in places])
        for place, value in zip(places, corrected, strict=True):
            adjusted[place] = math.nan if math.isnan(p[place]) else float(value)
    return list(zip(p, adjusted, strict=True))


def _tests_zero(question: Question) -> bool:
    return question.family is not None


def _answer(asked: _Asked, outcomes: Outcomes, p: float, p_holm: float, papers_p: float) -> Answer:
    question, whole = asked.question, asked.whole
    alpha = ALPHA if asked.number is None else level(asked.number)
    parts = tuple(_finding(question, part, outcomes, alpha) for part in asked.parts)
    decided = None if whole is None else _finding(question, whole, outcomes, alpha)
    ours, paper = _effect(whole, "ours"), _effect(whole, "paper")
    verdict, reason = _judge(question, parts, whole, ours, paper, p_holm, alpha)
    lack = _lack(asked, outcomes, verdict)
    if question.by_construction:
        verdict, reason = "holds by construction", question.by_construction
    elif lack:
        verdict, reason = lack
    papers: Verdict | None = None
    if whole is not None and paper is not None:
        last = level(len(LOOKS) - 1)
        as_ours = replace(whole, ours=paper, paper=None)
        papers, _ = _judge(question, (), as_ours, paper, None, papers_p, last)
    return Answer(
        question,
        verdict,
        reason,
        parts,
        decided,
        asked.seeds,
        p,
        p_holm,
        None if ours is None or paper is None else paper.predicts(ours, alpha),
        papers,
        _seeds_needed(ours, paper, asked.seeds),
        asked.fresh,
    )


def _lack(asked: _Asked, outcomes: Outcomes, verdict: Verdict) -> tuple[Verdict, str] | None:
    """Why the question cannot be answered here, if so."""
    cells = [cell for part in asked.parts for cell in part.cells]
    if not all(part.cells and part.papers_cells for part in asked.parts):
        return "not asked here", "the budget lacks the paper's cells"
    if leading(outcomes, cells) < asked.seeds or not asked.seeds:
        return "not asked here", "runs are missing"
    if asked.number is None:
        return "not asked here", f"{asked.seeds} seeds; the first look takes {LOOKS[0]}"
    generations = min(outcomes.budget.generations_of(cell.task) for cell in cells)
    reached = asked.question.kind == "ceiling" and verdict == "reproduced"
    if generations < PAPER_GENERATIONS and not reached:
        return "too short", f"{generations} of {PAPER_GENERATIONS} generations"
    return None


def _expects(question: Question) -> Expect | None:
    if isinstance(question, Difference | Interaction | Sensitivity):
        return question.expect
    return None


def _finding(question: Question, part: Evidence, outcomes: Outcomes, alpha: float) -> Finding:
    learning = {cell for cell in part.cells if cell.learning_rate is not None}
    near_control = bool(learning) and learning <= outcomes.near_control
    if part.ours is None:
        return Finding(part, part.state, math.nan, math.nan, near_control)
    low, high = part.ours.interval(1 - alpha)
    state = part.state or _state(part.ours, _expects(question), part.margin, alpha)
    return Finding(part, state, low, high, near_control)


def _state(ours: Effect, expect: Expect | None, margin: float, alpha: float) -> State:
    """Which side of 0, or of the margin, the interval lies on."""
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
    """Two one-sided tests (Schuirmann 1987)."""
    low, high = ours.interval(1 - 2 * alpha)
    return -margin < low and high < margin


def _judge(
    question: Question,
    parts: Sequence[Finding],
    whole: Evidence | None,
    ours: Effect | None,
    paper: Effect | None,
    p_holm: float,
    alpha: float,
) -> tuple[Verdict, str]:
    """The verdict on runs that are long and many enough."""
    states = {part.state for part in parts}
    if whole is None:
        if "against" in states:
            return "not reproduced", "a part is against"
        return ("reproduced", "") if states == {"for"} else ("inconclusive", "")
    if whole.state:
        return _OF_STATE[whole.state], ""
    if ours is None:
        return "inconclusive", "nothing varies"
    expect = _expects(question)
    if expect in ("equal", "not_lower"):
        state = _state(ours, expect, whole.margin, alpha)
        return _OF_STATE[state], ""
    return _of_difference(ours, paper, expect == "lower", whole.margin, p_holm, alpha, states)


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
    states: set[State | None],
) -> tuple[Verdict, str]:
    """The verdict where the paper claims a difference from 0."""
    sign = -1 if lower else 1
    predicted = paper is None or paper.predicts(ours, alpha)
    if p_holm < ALPHA and sign * ours.value > 0:
        if "against" in states:
            return "mixed", "a part points the other way"
        return ("reproduced", "") if predicted else ("same direction", "not of the paper's size")
    if p_holm < ALPHA:
        return "not reproduced", "the other direction"
    if _within(ours, margin, alpha):
        return "equivalent to zero", ""
    if paper is None:
        return "inconclusive", ""
    if not predicted and sign * (paper.value - ours.value) > 0:
        return "not reproduced", "smaller than the paper's numbers predict"
    low, high = ours.interval(1 - 2 * alpha)
    if (-low if lower else high) < paper.telescope:
        return "not reproduced", "smaller than the paper's seeds could have seen"
    return "inconclusive", ""


def _seeds_needed(ours: Effect | None, paper: Effect | None, seeds: int) -> float:
    """From the paper's effect and the spread of our runs, by normal theory."""
    if ours is None or paper is None or not ours.error or not paper.value:
        return math.nan
    z = stats.norm.isf(ALPHA / 2) + stats.norm.isf(1 - POWER)
    return float(math.ceil(seeds * (z * ours.error / paper.value) ** 2))
