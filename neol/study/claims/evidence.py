"""Evidence of runs on a question: the effects of its parts and of the question as a whole.

A part is one rule on one task. The whole is not a vote of the parts: its effect is the average of
all rules against the same baseline, averaged over the tasks.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal

import numpy as np
from scipy import stats

from neol.study.campaign.grid import Cell
from neol.study.campaign.methods import mutated
from neol.study.claims.effect import Effect, Summary, average, combined, difference
from neol.study.claims.parts import State, between_rates, ranked, share_state
from neol.study.claims.questions import (
    RULES,
    Ceiling,
    Difference,
    Interaction,
    Method,
    Printed,
    Question,
    Rank,
    Rule,
    Sensitivity,
    Side,
)
from neol.study.claims.sides import Choice, Runs, choose, printed
from neol.study.outcomes.outcomes import METRICS, Metric, Outcomes
from neol.study.outcomes.paper_numbers import settings
from neol.study.outcomes.statistics import Floats

LEAST_SEEDS = 6
"""Fewest seeds from which effects are computed; where a cell is chosen, half of them remain."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """Effects of our runs and of the paper's numbers, for a part of a question or the whole."""

    label: str
    cells: tuple[Cell, ...]
    """Cells whose runs it uses, or of which one is chosen."""
    papers_cells: bool
    """Whether the cells are all those of the paper's question."""
    ours: Effect | None = None
    """Effect of our runs; None if they are too few, or do not vary."""
    paper: Effect | None = None
    """Effect of the paper's numbers; None if it prints no such numbers."""
    margin: float = 0.0
    """Effects smaller than this count as none."""
    state: State | None = None
    """State of the part if a rule other than the effect's interval decides it."""


@dataclass(frozen=True, slots=True)
class Answered:
    """Evidence on all parts of a question, and on the whole; None where the parts decide."""

    parts: tuple[Evidence, ...]
    whole: Evidence | None


def evidence(question: Question, runs: Runs, alpha: float) -> Answered:
    """Return the evidence on a question; `alpha` is the level of parts with a rule of their own."""
    match question:
        case Difference():
            return _difference(question, runs)
        case Interaction():
            return _interaction(question, runs)
        case Sensitivity():
            return _sensitivity(question, runs)
        case Rank():
            return _rank(question, runs, alpha)
        case Ceiling():
            return _ceiling(question, runs, alpha)
        case Printed():
            return _printed(question, runs, alpha)


def _difference(question: Difference, runs: Runs) -> Answered:
    tasks = (*question.tasks, *question.than_tasks)
    side, against = question.side, question.against

    def of_task(task: str, rules: Sequence[Rule]) -> Evidence:
        ours, theirs = (
            _distinct(choose(runs.outcomes, each, task, each.method or rule) for rule in rules)
            for each in (side, against)
        )
        baseline = against.method or ""
        theirs_printed = printed(against, question.outcome, task, (baseline,), baseline)
        ours_printed = printed(side, question.outcome, task, tuple(rules), baseline)
        paper = None
        if ours_printed and theirs_printed:
            paper = difference(ours_printed, theirs_printed, question.statistic, question.scale)
        margin = question.margin
        if question.scale == "raw" and question.statistic == "mean":
            margin *= theirs_printed.sd if theirs_printed else 0.0

        def effect() -> Effect | None:
            outcome, statistic = question.outcome, question.statistic
            first, second = runs.summaries((ours, theirs), outcome, statistic)
            return difference(first, second, statistic, question.scale)

        label = f"{task}: {', '.join(rules)}"
        return _measured(label, (*ours, *theirs), runs, effect, paper, margin)

    def together(rules: Sequence[Rule]) -> Evidence:
        each = {task: of_task(task, rules) for task in tasks}
        first = _averaged([each[task] for task in question.tasks])
        if not question.than_tasks:
            return first
        second = _averaged([each[task] for task in question.than_tasks])
        return _minus(first, second)

    if question.than_tasks:
        parts = [replace(together([rule]), label=rule) for rule in question.rules]
    else:
        parts = [of_task(task, [rule]) for task, rule in product(tasks, question.rules)]
    return Answered(tuple(parts), together(question.rules))


def _interaction(question: Interaction, runs: Runs) -> Answered:
    def of_task(task: str, rules: Sequence[Rule]) -> Evidence:
        with_both, with_none = [], []
        for rule in rules:
            population, rate = settings(4)[task, rule]
            cells = [Cell(task, name, population, rate) for name in (mutated(rule), rule)]
            cells += [Cell(task, name, population, None) for name in ("neat", "neat_wo")]
            both, alone, neat, neither = (
                Choice((each,) if each in runs.outcomes.cells else (), False, True)
                for each in cells
            )
            with_both += [both, neither]
            with_none += [alone, neat]

        def effect() -> Effect | None:
            first, second = runs.summaries((with_both, with_none), question.outcome)
            found = difference(first, second, scale="sd")
            return found and combined([(2, found)])

        label = f"{task}: {', '.join(rules)}"
        choices = _distinct((*with_both, *with_none))
        return _measured(label, choices, runs, effect, None, question.margin)

    parts = [of_task(task, [rule]) for task, rule in product(question.tasks, question.rules)]
    whole = _averaged([of_task(task, question.rules) for task in question.tasks])
    return Answered(tuple(parts), whole)


def _sensitivity(question: Sensitivity, runs: Runs) -> Answered:
    grid = Side(cells="grid")

    def of_task(task: str, others: Sequence[Rule]) -> Evidence:
        choices = [choose(runs.outcomes, grid, task, rule) for rule in (question.rule, *others)]

        def effect() -> Effect | None:
            if any(len({cell.learning_rate for cell in each.cells}) < 2 for each in choices):
                return None
            varied, *rest = (_between_rates(each, runs, question.outcome) for each in choices)
            return combined([(1, varied), *((-1 / len(rest), each) for each in rest)])

        label = f"{task}: {question.rule} beside {', '.join(others)}"
        return _measured(label, choices, runs, effect, None)

    parts = [of_task(task, [other]) for task, other in product(question.tasks, question.than)]
    whole = _averaged([of_task(task, question.than) for task in question.tasks])
    return Answered(tuple(parts), whole)


def _rank(question: Rank, runs: Runs, alpha: float) -> Answered:
    side = Side(cells=question.cells)

    def of_task(task: str) -> Evidence:
        first, at_most = question.ranks[task].rule, question.ranks[task].at_most
        methods: list[Method] = [first, *(rule for rule in RULES if rule != first)]
        methods.append(question.against)
        choices = [choose(runs.outcomes, side, task, method) for method in methods]
        leads: list[Effect] = []

        def effect() -> Effect:
            best, *others = runs.summaries([[each] for each in choices], question.outcome)
            leads.extend(_leads(best, others))
            return _decisive(leads, at_most)

        summaries = [
            printed(side, question.outcome, task, (each,), question.against) for each in methods
        ]
        there = [each for each in summaries if each]
        paper = None
        if len(there) == len(summaries):
            paper = _decisive(_leads(there[0], there[1:]), at_most)
        label = f"{task}: {first} among the best {at_most}"
        found = _measured(label, choices, runs, effect, paper)
        return replace(found, state=ranked(leads, at_most, alpha) if leads else None)

    return Answered(tuple(of_task(task) for task in question.tasks), None)


def _ceiling(question: Ceiling, runs: Runs, alpha: float) -> Answered:
    def of_method(task: str, method: Method) -> Evidence:
        setting = Side(cells="table4" if method == "neat_wo" else "table3")
        choice = choose(runs.outcomes, setting, task, method)
        shares: list[Floats] = []

        def effect() -> Effect:
            ((values,),) = runs.tables([choice], "final_best")
            at_level = (values >= question.level).astype(float)
            shares.append(at_level)
            return Summary.of_runs(at_level[None]).mean

        found = _measured(f"{task}: {method}", [choice], runs, effect, None)
        if not shares:
            return found
        reached, n = int(shares[0].sum()), len(shares[0])
        return replace(found, state=share_state(reached, n, question.share, alpha))

    methods: tuple[Method, ...] = (*RULES, "neat", "neat_wo")
    parts = [of_method(task, method) for task, method in product(question.tasks, methods)]
    return Answered(tuple(parts), None)


def _printed(question: Printed, runs: Runs, alpha: float) -> Answered:
    tables: dict[Metric, tuple[Side, Side]] = {
        "final_best": (Side(cells="table3"), Side(cells="table4")),
        "score": (Side(cells="largest"), Side(cells="largest")),
    }
    methods: tuple[tuple[Method, Method], ...] = (
        *((rule, "neat") for rule in RULES),
        ("neat", "neat"),
        ("neat_wo", "neat_wo"),
    )
    places = list(product(tables, question.tasks, methods))

    def of_method(outcome: Metric, task: str, method: Method, table: Method) -> Evidence:
        side = tables[outcome][table == "neat_wo"]
        choice = choose(runs.outcomes, side, task, method)
        paper = printed(side, outcome, task, (method,), table)

        def effect() -> Effect:
            (summary,) = runs.summaries([[choice]], outcome)
            return summary.mean

        mean = None if paper is None else paper.mean
        found = _measured(f"{task}: {METRICS[outcome]} of {method}", [choice], runs, effect, mean)
        if found.ours is None or found.paper is None:
            return found
        return replace(found, state="for" if _p_same(found) >= alpha else "against")

    parts = [of_method(outcome, task, *each) for outcome, task, each in places]
    cells = tuple(cell for part in parts for cell in part.cells)
    whole = Evidence("all", cells, all(part.papers_cells for part in parts))
    if all(part.ours and part.paper for part in parts):
        p = stats.combine_pvalues([_p_same(part) for part in parts], method="fisher").pvalue
        whole = replace(whole, state="for" if p >= alpha else "against")
    return Answered(tuple(parts), whole)


def _p_same(part: Evidence) -> float:
    """Return the p-value of the hypothesis that our mean and the paper's are equal."""
    assert part.ours and part.paper
    return combined([(1, part.ours), (-1, part.paper)]).p()


def _between_rates(choice: Choice, runs: Runs, outcome: Metric) -> Effect:
    """Return the variance between rates in units of that over seeds, with jackknife error."""
    (table,) = runs.tables([choice], outcome)
    sizes = np.array([cell.population for cell in choice.cells])
    noise = table.var(axis=1, ddof=1).mean() or 1.0

    def measure(values: Floats) -> float:
        each = [between_rates(values[sizes == size]) for size in np.unique(sizes)]
        return float(np.mean(each) / noise)

    n = table.shape[1]
    without = np.array([measure(np.delete(table, seed, axis=1)) for seed in range(n)])
    error = np.sqrt((n - 1) / n * np.sum((without - without.mean()) ** 2))
    return Effect(measure(table), float(error), n - 1)


def _leads(first: Summary, others: Sequence[Summary]) -> list[Effect]:
    return [combined([(1, first.mean), (-1, other.mean)]) for other in others]


def _decisive(leads: Sequence[Effect], at_most: int) -> Effect:
    """Return the lead over the best of the methods that must be lower."""
    return sorted(leads, key=lambda lead: lead.value)[at_most - 1]


def _measured(
    label: str,
    choices: Sequence[Choice],
    runs: Runs,
    effect: Callable[[], Effect | None],
    paper: Effect | None,
    margin: float = 0.0,
) -> Evidence:
    """Return evidence whose effect is computed if there are enough runs."""
    cells = tuple(cell for choice in choices for cell in choice.cells)
    papers = all(choice.cells and choice.papers for choice in choices)
    enough = runs.end - runs.begin >= LEAST_SEEDS
    complete = leading(runs.outcomes, cells) >= runs.end
    there = enough and complete and all(choice.cells for choice in choices)
    ours = effect() if there else None
    return Evidence(label, cells, papers, ours, paper, margin)


def _averaged(each: Sequence[Evidence]) -> Evidence:
    """Return the average over tasks, or over parts."""
    if len(each) == 1:
        return each[0]
    ours, paper = ([getattr(one, name) for one in each] for name in ("ours", "paper"))
    return Evidence(
        "all",
        tuple(cell for one in each for cell in one.cells),
        all(one.papers_cells for one in each),
        None if None in ours else average(ours),
        None if None in paper else average(paper),
        float(np.mean([one.margin for one in each])),
    )


def _minus(first: Evidence, second: Evidence) -> Evidence:
    """Return the first side's effect minus the second's."""

    def effect(name: Literal["ours", "paper"]) -> Effect | None:
        one, other = getattr(first, name), getattr(second, name)
        return None if one is None or other is None else combined([(1, one), (-1, other)])

    return Evidence(
        "all",
        (*first.cells, *second.cells),
        first.papers_cells and second.papers_cells,
        effect("ours"),
        effect("paper"),
        first.margin,
    )


def _distinct(choices: Iterator[Choice] | Sequence[Choice]) -> tuple[Choice, ...]:
    return tuple(dict.fromkeys(choices))


def leading(outcomes: Outcomes, cells: Sequence[Cell]) -> int:
    """Return how many of the first seeds all cells have."""
    return min((outcomes.leading(cell) for cell in cells), default=0)
