"""The paper's Tables 1 to 8 from a budget's records, each value beside the paper's own."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict

import numpy as np
import pandas as pd

from neol.network.rules import BASELINES
from neol.pictures.labels import method_label, task_label
from neol.study.campaign.grid import Cell
from neol.study.campaign.methods import challengers
from neol.study.outcomes import paper_numbers
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import SETTINGS, candidates
from neol.study.outcomes.contrasts import WHY_THEY_DIFFER
from neol.study.outcomes.contrasts import compare as compare_runs
from neol.study.outcomes.movement import NEAR_CONTROL_NOTE
from neol.study.outcomes.statistics import ALPHA, rank_sum, superiority
from neol.study.output.captions import (
    describe_budget,
    describe_largest_population,
    describe_samples,
)
from neol.study.tables import formats
from neol.study.tables.summary import OursAndPapers, OwnSummary, Summary, compare
from neol.study.tables.table import Entry, Line, Table

CHOSEN_OF_FOUR = 0.075
"""Share of simulations in which the best of four cells tests higher than an equal fifth one.

Each cell has 30 seeds; the two-sided rank-sum test at `ALPHA` finds 2.5% without the choice.
"""
_RANKED = (
    "the paper's value is beneath each. Bold marks a row's highest mean, underline (italics on web "
    "pages) the runner-up; equal means are marked alike, and a shared first place leaves no "
    "runner-up."
)
_ABLATION = " NEAT (w/o) is NEAT without weight mutation."
_CHOICE = (
    "the paper's own beneath each. The paper's is taken if the budget's grid has it, where a task "
    "has these configurations alone with its largest population; otherwise the cell of the grid "
    "with the highest mean of the best final-generation fitness over seeds (ties: the smaller "
    "population, then the smaller rate)."
)

# --- Means --------------------------------------------------------------------------------------


def table1(campaign: Campaign) -> Table:
    """Table 1: best final-generation fitness, mean and standard deviation over seeds."""
    return _best_fitness(1, campaign, "table3")


def table7(campaign: Campaign) -> Table:
    """Table 7: best final-generation fitness against NEAT without weight mutation."""
    return _best_fitness(7, campaign, "table4", _ABLATION)


def table2(campaign: Campaign) -> Table:
    """Table 2: SCORE at the largest population and each method's best learning rate."""
    return _scores(2, campaign, "neat")


def table8(campaign: Campaign) -> Table:
    """Table 8: SCORE against NEAT without weight mutation."""
    return _scores(8, campaign, "neat_wo", _ABLATION)


def table3(campaign: Campaign) -> Table:
    """Table 3: the configurations that Table 1 shows."""
    return _configurations(3, campaign, "table3", behind=1)


def table4(campaign: Campaign) -> Table:
    """Table 4: the configurations that Table 7 shows."""
    return _configurations(4, campaign, "table4", behind=7)


def _best_fitness(number: int, campaign: Campaign, setting: str, remark: str = "") -> Table:
    title = (
        f"Best final-generation fitness, mean ± SD over seeds (n - 1 in its denominator); {_RANKED}"
        f"{remark} Final fitness is a maximum over noisy episodes, so champions' mean return in "
        f"fresh episodes is given too. Configurations: Table {SETTINGS[setting].paper_table}."
    )
    methods = SETTINGS[setting].methods(campaign.configuration.budget)
    return _means(number, title, formats.fitness, campaign, setting, methods, number, fresh=True)


def _scores(number: int, campaign: Campaign, against: str, remark: str = "") -> Table:
    budget = campaign.configuration.budget
    title = (
        "SCORE (sample efficiency), mean ± SD over seeds, at population "
        f"{describe_largest_population(budget)} and each method's best learning rate, with "
        f"M = {describe_samples(campaign)}; {_RANKED}{remark}"
    )
    methods = (*challengers(budget), against)
    return _means(number, title, formats.score, campaign, "score", methods, number)


def _configurations(number: int, campaign: Campaign, setting: str, behind: int) -> Table:
    methods = SETTINGS[setting].methods(campaign.configuration.budget)
    title = f"Configurations behind Table {behind}, {_CHOICE}"
    return _means(number, title, formats.setting, campaign, setting, methods, behind)


def lead_over_neat(table: Table) -> pd.DataFrame:
    """Return each rule's mean minus NEAT's, here and in the paper: a row for each task."""
    columns = {}
    for method in [method for method in table.frame["method"].unique() if method != "neat"]:
        for place, mean in (("here", "mean"), ("paper", "paper_mean")):
            means = table.frame.pivot(index="task", columns="method", values=mean)
            columns[method_label(method), place] = means[method] - means["neat"]
    leads = pd.DataFrame(columns).reindex(table.frame["task"].unique())
    return leads.rename(index=task_label).rename_axis(None).round(2)


# --- p-values -----------------------------------------------------------------------------------


def table5(campaign: Campaign) -> Table:
    """Table 5: p-values of the rank-sum test against NEAT, of the fitness that Table 1 shows."""
    return _p_values(5, "best final-generation fitness (Table 1)", campaign, "table3")


def table6(campaign: Campaign) -> Table:
    """Table 6: p-values of the rank-sum test against NEAT, of the SCORE that Table 2 shows."""
    return _p_values(6, "SCORE (Table 2)", campaign, "score")


def _p_values(number: int, outcome: str, campaign: Campaign, setting: str) -> Table:
    budget = campaign.configuration.budget
    rules = challengers(budget)
    frame = _tests(number, campaign, setting, rules)
    title = (
        f"Two-sided Wilcoxon rank-sum test of {outcome}, each rule against NEAT: p-values, with "
        f"the paper's beneath, which are two-sided too. Bold: below {ALPHA}, in either direction. "
        f"The p-values are not corrected for their number. {WHY_THEY_DIFFER} The difference is in "
        f"table{number}.csv and, with Holm's correction, in beyond_effects.csv."
    )
    marks = formats.marks(frame["incomplete"])
    lines = []
    for task in budget.tasks:
        row = frame[frame["task"] == task]
        ours = [
            formats.marked(formats.p_value(p, 2), marks.get(why), near_control=little)
            for p, why, little in zip(row["p"], row["incomplete"], row["near_control"], strict=True)
        ]
        papers = [formats.p_value(p, 3 if number == 5 else 2) for p in row["paper_p"]]
        beneath = {"paper": papers}
        lines += formats.lines_of(campaign.configuration, setting, task, ours, beneath)
    columns = tuple(f"{method_label(rule)} vs NEAT" for rule in rules)
    return _table(number, title, columns, lines, marks, frame, campaign, setting, (*rules, "neat"))


def _tests(number: int, campaign: Campaign, setting: str, rules: Sequence[str]) -> pd.DataFrame:
    """Return the test of each rule against NEAT on each task, here and in the paper, one a row."""
    means = {
        (each.task, each.method): each.here
        for each in compare(campaign, setting, number, (*rules, "neat"))
    }
    printed = paper_numbers.values(number)
    rows = []
    for task in campaign.configuration.budget.tasks:
        neat = means[task, "neat"]
        against = _sample(campaign, task, "neat", neat, setting)
        for rule in rules:
            here = means[task, rule]
            sample = _sample(campaign, task, rule, here, setting)
            ours, theirs = (np.array(list(side.values())) for side in (sample, against))
            primary = compare_runs(sample, against)
            paper, _ = printed.get((task, f"{rule}_vs_neat"), (math.nan, None))
            rows.append(
                {
                    "task": task,
                    "method": rule,
                    **primary,
                    "p_welch": primary["p"],
                    "p": rank_sum(ours, theirs),
                    "a12": float(superiority(ours, theirs)) if primary["seeds"] else math.nan,
                    "incomplete": here.incomplete or neat.incomplete,
                    "near_control": here.near_control,
                    "paper_p": paper,
                    "paper_a12": paper_numbers.paper_a12(number, task, rule),
                }
            )
    return pd.DataFrame(rows)


def _sample(
    campaign: Campaign, task: str, method: str, here: OwnSummary, setting: str
) -> dict[int, float]:
    """Return the outcomes by seed of the cell that a summary describes; empty without a cell."""
    if here.population is None:
        return {}
    cell = Cell(task, method, here.population, here.learning_rate)
    return campaign.values(cell, SETTINGS[setting].metric)


# --- Common -------------------------------------------------------------------------------------


def _means(
    number: int,
    title: str,
    entry: Callable[[Summary], Entry],
    campaign: Campaign,
    setting: str,
    methods: Sequence[str],
    values: int,
    *,
    fresh: bool = False,
) -> Table:
    """Return a table whose entries `entry` formats; the paper's table `values` has its means.

    With `fresh`, the champions' mean return in fresh episodes is beneath each value.
    """
    comparisons = compare(campaign, setting, values, methods)
    marks = formats.marks(each.here.incomplete for each in comparisons)
    lines = []
    for task in campaign.configuration.budget.tasks:
        row = [each for each in comparisons if each.task == task]
        ours = [
            formats.marked(
                entry(each.here),
                marks.get(each.here.incomplete),
                near_control=each.here.near_control,
            )
            for each in row
        ]
        beneath = {"paper": [entry(each.paper) for each in row]}
        if fresh:
            beneath["in fresh episodes"] = [formats.held_out(each.here) for each in row]
        lines += formats.lines_of(campaign.configuration, setting, task, ours, beneath)
    frame = pd.DataFrame([_flat(each) for each in comparisons])
    frame = frame.astype({"population": "Int64", "paper_population": "Int64"})
    columns = tuple(method_label(method) for method in methods)
    return _table(number, title, columns, lines, marks, frame, campaign, setting, methods)


def _table(
    number: int,
    title: str,
    columns: tuple[str, ...],
    lines: Sequence[Line],
    marks: Mapping[str, str],
    frame: pd.DataFrame,
    campaign: Campaign,
    setting: str,
    methods: Sequence[str],
) -> Table:
    configuration = campaign.configuration
    incomplete = [f"{mark} {reason}." for reason, mark in marks.items()]
    shown = {
        place: among
        for place, among in candidates(configuration, setting).items()
        if place[1] in methods
    }
    return Table(
        name=f"table{number}",
        number=str(number),
        caption=f"{title} {describe_budget(configuration)}",
        columns=columns,
        lines=tuple(lines),
        notes=(
            *incomplete,
            *([NEAR_CONTROL_NOTE] if frame["near_control"].any() else []),
            *_flattered(shown),
            *paper_numbers.CONTRADICTIONS.get(number, ()),
        ),
        frame=frame,
        configuration=configuration,
        sources=campaign.sources(cell for among in shown.values() for cell in among),
    )


def _flattered(shown: Mapping[tuple[str, str], Sequence[Cell]]) -> list[str]:
    """Note that a rule was chosen among more cells than NEAT, by the runs that are tested."""
    rules, neat = (
        max((len(among) for (_, method), among in shown.items() if method in some), default=0)
        for some in ({method for _, method in shown} - set(BASELINES), BASELINES)
    )
    if rules <= neat:
        return []
    return [
        f"Selection favours rules: a rule's cell is the best of up to {rules}, NEAT's of {neat}, "
        "chosen by the same seeds that are shown and tested. In a simulation of equal methods "
        "(normal outcomes, 30 seeds, the best of 4 cells against 1) the test at "
        f"{ALPHA} finds the rule higher in {CHOSEN_OF_FOUR:.1%} of cases instead of "
        f"{ALPHA / 2:.1%}."
    ]


def _flat(comparison: OursAndPapers) -> dict[str, object]:
    return {
        "task": comparison.task,
        "method": comparison.method,
        **asdict(comparison.here),
        **{f"paper_{name}": value for name, value in asdict(comparison.paper).items()},
    }
