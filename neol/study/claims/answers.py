"""The answers to the paper's questions: evidence, looks, families and verdicts together."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from scipy import stats

from neol.study.claims.effect import Effect
from neol.study.claims.evidence import Evidence, leading
from neol.study.claims.kinds import evidence
from neol.study.claims.looks import LOOKS, level, look, overall_p
from neol.study.claims.parts import State
from neol.study.claims.questions import Question
from neol.study.claims.sides import Runs
from neol.study.claims.verdicts import Verdict, expects, judge, state_of
from neol.study.outcomes.outcomes import Outcomes
from neol.study.outcomes.score import PAPER_GENERATIONS
from neol.study.outcomes.statistics import ALPHA, POWER, holm


@dataclass(frozen=True, slots=True)
class Finding:
    """Evidence on one part of a question, or on the whole, with its state and interval."""

    evidence: Evidence
    state: State | None
    """For, against or open at this look; None without an effect."""
    low: float
    high: float
    """Ends of the interval at this look's level."""
    near_control: bool = False
    """Whether its rules hardly move a weight, so that learning cannot explain it."""


@dataclass(frozen=True, slots=True)
class Answer:
    """A question and its answer from runs."""

    question: Question
    verdict: Verdict
    reason: str
    parts: tuple[Finding, ...]
    whole: Finding | None
    seeds: int
    """Seeds of each method at the last complete look."""
    level: float
    """Coverage of its intervals: 1 minus the level of this look's tests."""
    p: float
    """Two-sided p-value of the whole, corrected for all looks; NaN where 0 is not tested, or cannot
    be by these runs."""
    p_holm: float
    """The p-value corrected also over the question's family (Holm)."""
    compatible: bool | None
    """Whether our effect lies where the paper's numbers predict it; None without such numbers."""
    papers: Verdict | None
    """The verdict on the paper's own numbers; None where it prints none."""
    seeds_needed: float
    """Seeds that detect the paper's effect with a power of 80%; NaN if unknown."""
    fresh: Effect | None
    """Effect of the whole from seeds 10 and up alone, which no smaller budget has shown."""

    @property
    def counts(self) -> dict[State, int]:
        """Return the numbers of parts for, against and open."""
        found = Counter(part.state or "open" for part in self.parts)
        return {"for": found["for"], "against": found["against"], "open": found["open"]}

    @property
    def near_control(self) -> bool:
        """Return whether all parts with a rule are near control: then no rule learned anything."""
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
    """Number of the look."""
    lack: tuple[Verdict, str] | None
    """Why these runs cannot answer it, as a verdict and its reason; None if they can."""
    fresh: Effect | None


def answers(questions: Sequence[Question], outcomes: Outcomes) -> tuple[Answer, ...]:
    """Answer all questions; Holm's correction needs them together."""
    asked = [_ask(question, outcomes) for question in questions]
    ours = _corrected(
        questions,
        [None if each.lack else _effect(each.whole, "ours") for each in asked],
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
    lack = _lack(found.parts, end, number, outcomes)
    return _Asked(question, found.parts, found.whole, end, number, lack, fresh)


def _effect(whole: Evidence | None, name: Literal["ours", "paper"]) -> Effect | None:
    return None if whole is None else getattr(whole, name)


def _corrected(
    questions: Sequence[Question],
    effects: Sequence[Effect | None],
    looks: Sequence[int],
    unanswered: float,
) -> list[tuple[float, float]]:
    """Return repeated p-values, and the same with Holm's correction over each family.

    `unanswered` is the p-value with which a question whose effect is None counts in its family; NaN
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
    states = {part.state for part in parts}
    verdict, reason = judge(question, states, whole, p_holm, alpha)
    if question.by_construction:
        verdict, reason = "holds by construction", question.by_construction
    elif asked.lack and not _is_reached(asked, verdict):
        verdict, reason = asked.lack
    papers: Verdict | None = None
    if whole is not None and paper is not None:
        last = level(len(LOOKS) - 1)
        as_ours = replace(whole, ours=paper, paper=None)
        papers, _ = judge(question, (), as_ours, papers_p, last)
    return Answer(
        question,
        verdict,
        reason,
        parts,
        decided,
        asked.seeds,
        1 - alpha,
        p,
        p_holm,
        None if ours is None or paper is None else paper.predicts(ours, alpha),
        papers,
        _seeds_needed(ours, paper, asked.seeds),
        asked.fresh,
    )


def _lack(
    parts: Sequence[Evidence], seeds: int, number: int | None, outcomes: Outcomes
) -> tuple[Verdict, str] | None:
    """Return why a question cannot be answered here; None if it can."""
    cells = [cell for part in parts for cell in part.cells]
    if not all(part.cells and part.papers_cells for part in parts):
        return "not asked here", "the budget lacks the paper's cells"
    if leading(outcomes, cells) < seeds or not seeds:
        return "not asked here", "runs are missing"
    if number is None:
        return "not asked here", f"{seeds} seeds; the first look takes {LOOKS[0]}"
    generations = min(outcomes.budget.generations_of(cell.task) for cell in cells)
    if generations < PAPER_GENERATIONS:
        return "too short", f"{generations} of {PAPER_GENERATIONS} generations"
    return None


def _is_reached(asked: _Asked, verdict: Verdict) -> bool:
    """Return whether short runs have reached a maximum already, which more cannot change."""
    is_short = asked.lack is not None and asked.lack[0] == "too short"
    return is_short and asked.question.kind == "ceiling" and verdict == "reproduced"


def _finding(question: Question, part: Evidence, outcomes: Outcomes, alpha: float) -> Finding:
    learning = {cell for cell in part.cells if cell.learning_rate is not None}
    near_control = bool(learning) and learning <= outcomes.near_control
    if part.ours is None:
        return Finding(part, part.state, math.nan, math.nan, near_control)
    low, high = part.ours.interval(1 - alpha)
    state = part.state or state_of(part.ours, expects(question), part.margin, alpha)
    return Finding(part, state, low, high, near_control)


def _seeds_needed(ours: Effect | None, paper: Effect | None, seeds: int) -> float:
    """Return the seeds that detect the paper's effect, from our runs' spread (normal theory)."""
    if ours is None or paper is None or not ours.error or not paper.value:
        return math.nan
    z = stats.norm.isf(ALPHA / 2) + stats.norm.isf(1 - POWER)
    return float(math.ceil(seeds * (z * ours.error / paper.value) ** 2))
