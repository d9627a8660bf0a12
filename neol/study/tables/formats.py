"""Formats of values in the paper's tables, and marks of incomplete ones."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from string import ascii_lowercase

from neol.pictures.labels import task_label, three_figures
from neol.spec.configuration import Configuration
from neol.study.outcomes.chosen_cells import candidates
from neol.study.outcomes.movement import NEAR_CONTROL_MARK
from neol.study.outcomes.statistics import ALPHA
from neol.study.tables.summary import OwnSummary, Summary
from neol.study.tables.table import Entry, Line

NOTHING = "--"


def marks(reasons: Iterable[str]) -> dict[str, str]:
    """Return a letter for each reason why a value is incomplete: (a) to (z), then (aa) onwards."""
    distinct = dict.fromkeys(reason for reason in reasons if reason)
    letters = len(ascii_lowercase)
    return {
        reason: f"({ascii_lowercase[i % letters] * (i // letters + 1)})"
        for i, reason in enumerate(distinct)
    }


def marked(entry: Entry, mark: str | None, *, near_control: bool = False) -> Entry:
    """Return the entry followed by its marks: of a cell near control, and `mark` if given."""
    text = f"{entry.text}{NEAR_CONTROL_MARK * near_control}"
    return Entry(f"{text} {mark}" if mark else text, entry.emphasis)


def lines_of(
    configuration: Configuration,
    setting: str,
    task: str,
    ours: Sequence[Entry],
    beneath: Mapping[str, Sequence[Entry]],
) -> list[Line]:
    """Return a task's line, and the labelled lines beneath it, in a table of this setting."""
    label = task_label(task) + _size(configuration, setting, task)
    return [
        Line(label, tuple(ours), is_beneath=False),
        *(Line(label, tuple(entries), is_beneath=True) for label, entries in beneath.items()),
    ]


def _size(configuration: Configuration, setting: str, task: str) -> str:
    """Return a task's generations, populations and seeds, as far as the budget's tasks differ.

    The populations are those of the cells that the setting chooses among.
    """
    budget, populations = configuration.budget, dict[str, set[int]]()
    for (each, _), among in candidates(configuration, setting).items():
        populations.setdefault(each, set()).update(cell.population for cell in among)
    sizes = {
        each: (
            f"G = {budget.generations_of(each)}",
            f"P = {', '.join(map(str, sorted(populations[each])))}",
            f"{len(budget.seeds_of(each))} seeds",
        )
        for each in budget.tasks
    }
    kinds = [set(kind) for kind in zip(*sizes.values(), strict=True)]
    differing = [said for said, kind in zip(sizes[task], kinds, strict=True) if len(kind) > 1]
    return f" ({', '.join(differing)})" if differing else ""


def fitness(summary: Summary) -> Entry:
    """Format mean and deviation as Table 1 does: 324.34 ± 3.86."""
    return _mean_sd(summary, lambda value: f"{value:.2f}")


def held_out(summary: OwnSummary) -> Entry:
    """Format the mean return of the runs' champions in fresh episodes: 87.0."""
    return Entry(three_figures(summary.held_out) if summary.seeds else NOTHING)


def score(summary: Summary) -> Entry:
    """Format SCORE with three significant figures, as Table 2 does: 0.451 ± 0.0122."""
    return _mean_sd(summary, three_figures)


def _mean_sd(summary: Summary, number: Callable[[float], str]) -> Entry:
    if math.isnan(summary.mean):
        return Entry(NOTHING)
    sd = NOTHING if math.isnan(summary.sd) else number(summary.sd)
    return Entry(f"{number(summary.mean)} ± {sd}", summary.rank)


def setting(summary: Summary) -> Entry:
    """Format a configuration as Table 3 does: pop=300, lr=0.25."""
    if summary.population is None:
        return Entry(NOTHING)
    rate = "" if summary.learning_rate is None else f", lr={summary.learning_rate:g}"
    return Entry(f"pop={summary.population}{rate}")


def p_value(p: float, decimals: int) -> Entry:
    """Format a p-value, bold below 0.05: 1.20e-8."""
    if math.isnan(p):
        return Entry(NOTHING)
    digits, exponent = f"{p:.{decimals}e}".split("e")
    return Entry(f"{digits}e{int(exponent)}", "best" if p < ALPHA else "")
