"""How runs answer each kind of question: the effects that its parts and the whole compare."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from scipy import stats

from neol.study.campaign.grid import Cell
from neol.study.campaign.methods import mutated
from neol.study.campaign.reference import settings
from neol.study.claims.effect import Effect, Summary, combined, difference
from neol.study.claims.evidence import Answered, Evidence, averaged, measured, minus
from neol.study.claims.parts import between_rates, ranked, share_state
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
from neol.study.outcomes.outcomes import METRICS, Metric
from neol.study.outcomes.statistics import Floats


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
        return measured(label, (*ours, *theirs), runs, effect, paper, margin)

    def together(rules: Sequence[Rule]) -> Evidence:
        each = {task: of_task(task, rules) for task in tasks}
        first = averaged([each[task] for task in question.tasks])
        if not question.than_tasks:
            return first
        second = averaged([each[task] for task in question.than_tasks])
        return minus(first, second)

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
        return measured(label, choices, runs, effect, None, question.margin)

    parts = [of_task(task, [rule]) for task, rule in product(question.tasks, question.rules)]
    whole = averaged([of_task(task, question.rules) for task in question.tasks])
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
        return measured(label, choices, runs, effect, None)

    parts = [of_task(task, [other]) for task, other in product(question.tasks, question.than)]
    whole = averaged([of_task(task, question.than) for task in question.tasks])
    return Answered(tuple(parts), whole)


def _rank(question: Rank, runs: Runs, alpha: float) -> Answered:
    side = Side(cells=question.cells)

    def of_task(task: str) -> Evidence:
        first, at_most = question.ranks[task].rule, question.ranks[task].at_most
        methods: list[Method] = [first, *(rule for rule in RULES if rule != first)]
        methods.append(question.against)
        choices = [choose(runs.outcomes, side, task, method) for method in methods]

        def leads() -> list[Effect]:
            best, *others = runs.summaries([[each] for each in choices], question.outcome)
            return _leads(best, others)

        summaries = [
            printed(side, question.outcome, task, (each,), question.against) for each in methods
        ]
        there = [each for each in summaries if each]
        paper = None
        if len(there) == len(summaries):
            paper = _decisive(_leads(there[0], there[1:]), at_most)
        label = f"{task}: {first} among the best {at_most}"
        found = measured(label, choices, runs, lambda: _decisive(leads(), at_most), paper)
        return replace(found, state=ranked(leads(), at_most, alpha)) if found.ours else found

    return Answered(tuple(of_task(task) for task in question.tasks), None)


def _ceiling(question: Ceiling, runs: Runs, alpha: float) -> Answered:
    def of_method(task: str, method: Method) -> Evidence:
        setting = Side(cells="table4" if method == "neat_wo" else "table3")
        choice = choose(runs.outcomes, setting, task, method)

        def at_level() -> Floats:
            ((values,),) = runs.tables([choice], "final_best")
            reached: Floats = (values >= question.level).astype(float)
            return reached

        def share() -> Effect:
            return Summary.of_runs(at_level()[None]).mean

        found = measured(f"{task}: {method}", [choice], runs, share, None)
        if found.ours is None:
            return found
        reached = at_level()
        return replace(
            found, state=share_state(int(reached.sum()), len(reached), question.share, alpha)
        )

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
        found = measured(f"{task}: {METRICS[outcome]} of {method}", [choice], runs, effect, mean)
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


def _distinct(choices: Iterator[Choice] | Sequence[Choice]) -> tuple[Choice, ...]:
    return tuple(dict.fromkeys(choices))
