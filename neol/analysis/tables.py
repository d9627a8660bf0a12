"""The paper's Tables 1 to 8 from a budget's records, each value beside the paper's own."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from string import ascii_lowercase

import numpy as np
import pandas as pd

from neol.analysis import reference
from neol.analysis.choice import SETTINGS, candidates
from neol.analysis.labels import METHODS, task_label
from neol.analysis.runs import Campaign
from neol.analysis.statistics import Floats, holm, rank_sum, superiority
from neol.analysis.summary import Comparison, OwnSummary, Summary, compare
from neol.analysis.table import Entry, Line, Table
from neol.campaign import Cell, cells
from neol.spec import Configuration, load_configuration

RULES = ("bcm", "hebb", "oja")
ALPHA = 0.05
NOTHING = "--"
CHOSEN_OF_FOUR = 0.14
"""How often equal methods differ at `ALPHA`, when one is the best of four cells, of 30 seeds each.

Simulated: the rank-sum test of the cell with the highest of four means against a fifth cell.
"""
_RANKED = (
    "beneath each value the paper's own. Bold marks a row's highest mean, underline the runner-up; "
    "equal means are marked alike, and a shared first place leaves no runner-up."
)
_CHOICE = (
    "beneath each the paper's own. Where the budget's grid has the paper's, it is taken; otherwise "
    "the cell of the grid with the highest mean of the best final-generation fitness over seeds "
    "(of equal means the smaller population, then the smaller rate)."
)

# --- Means --------------------------------------------------------------------------------------


def table1(campaign: Campaign) -> Table:
    """Table 1: best final-generation fitness, mean and standard deviation over seeds."""
    title = (
        "Best final-generation fitness, mean ± SD over seeds (n - 1 in its denominator); "
        f"{_RANKED} The configurations are those of Table 3."
    )
    return _means(1, title, _fitness, campaign, "table3", SETTINGS["table3"].methods)


def table2(campaign: Campaign) -> Table:
    """Table 2: SCORE at the largest population and each method's best learning rate."""
    title = f"{_score_title(campaign)} {_RANKED}"
    return _means(2, title, _score, campaign, "score", (*RULES, "neat"))


def table3(campaign: Campaign) -> Table:
    """Table 3: the configurations that Table 1 shows."""
    title = f"Configurations behind Table 1, {_CHOICE}"
    return _means(3, title, _setting, campaign, "table3", SETTINGS["table3"].methods, values=1)


def table4(campaign: Campaign) -> Table:
    """Table 4: the configurations that Table 7 shows."""
    title = f"Configurations behind Table 7, {_CHOICE}"
    return _means(4, title, _setting, campaign, "table4", SETTINGS["table4"].methods, values=7)


def table7(campaign: Campaign) -> Table:
    """Table 7: best final-generation fitness against NEAT without weight mutation."""
    title = (
        "Ablation: best final-generation fitness, mean ± SD over seeds; NEAT (w/o) is NEAT without "
        f"weight mutation; {_RANKED} The configurations are those of Table 4."
    )
    return _means(7, title, _fitness, campaign, "table4", SETTINGS["table4"].methods)


def table8(campaign: Campaign) -> Table:
    """Table 8: SCORE against NEAT without weight mutation."""
    title = f"Ablation: {_score_title(campaign)} {_RANKED}"
    return _means(8, title, _score, campaign, "score", (*RULES, "neat_wo"))


def lead_over_neat(table: Table) -> pd.DataFrame:
    """How far each rule's mean is above NEAT's, here and in the paper: a row for each task."""
    columns = {}
    for method in RULES:
        for place, mean in (("here", "mean"), ("paper", "paper_mean")):
            means = table.frame.pivot(index="task", columns="method", values=mean)
            columns[METHODS[method], place] = means[method] - means["neat"]
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
    means = {
        (each.task, each.method): each.here
        for each in compare(campaign, setting, number, (*RULES, "neat"))
    }
    printed = reference.values(number)
    rows = []
    for task in campaign.configuration.budget.tasks:
        neat = means[task, "neat"]
        against = _sample(campaign, task, "neat", neat, setting)
        for method in RULES:
            here = means[task, method]
            sample = _sample(campaign, task, method, here, setting)
            seeds = min(len(sample), len(against))
            paper, _ = printed.get((task, f"{method}_vs_neat"), (math.nan, None))
            rows.append(
                {
                    "task": task,
                    "method": method,
                    "p": rank_sum(sample, against),
                    "a12": float(superiority(sample, against)) if seeds else math.nan,
                    "seeds": seeds,
                    "incomplete": here.incomplete or neat.incomplete,
                    "paper_p": paper,
                    "paper_a12": reference.paper_a12(number, task, method),
                }
            )
    frame = pd.DataFrame(rows)
    frame.insert(3, "p_holm", holm(frame["p"].tolist()))
    title = (
        f"One-sided Wilcoxon rank-sum test of {outcome}, each rule against NEAT: p-values, beneath "
        "each the paper's own. Bold: below 0.05."
    )
    marks = _marks(frame["incomplete"])
    lines = []
    for task in campaign.configuration.budget.tasks:
        row = frame[frame["task"] == task]
        ours = [
            _mark(_p(p, 2), marks.get(why))
            for p, why in zip(row["p"], row["incomplete"], strict=True)
        ]
        papers = [_p(p, 3 if number == 5 else 2) for p in row["paper_p"]]
        lines += _two_lines(task, ours, papers)
    columns = tuple(f"{METHODS[method]} vs NEAT" for method in RULES)
    return _table(number, title, columns, lines, marks, frame, campaign, setting, (*RULES, "neat"))


def _sample(campaign: Campaign, task: str, method: str, here: OwnSummary, setting: str) -> Floats:
    """The outcomes of the cell that a summary is of; none where there is no such cell."""
    if here.population is None:
        return np.array([])
    cell = Cell(task, method, here.population, here.learning_rate)
    return np.array(list(campaign.values(cell, SETTINGS[setting].metric).values()))


# --- Common -------------------------------------------------------------------------------------


def describe_budget(configuration: Configuration, tasks: Sequence[str] = ()) -> str:
    """A budget in a sentence or two, for captions that concern some of its tasks, or all."""
    budget = configuration.budget
    sentence = (
        f"Budget {budget.name}: G = {budget.generations} generations, {budget.seeds} seeds, "
        f"{describe_episodes(configuration, tasks)}."
    )
    is_paper = configuration == load_configuration("paper")
    return sentence if is_paper else f"{sentence} Reduced budget: not the paper's."


def describe_episodes(configuration: Configuration, tasks: Sequence[str] = ()) -> str:
    """Number and length of episodes, for captions that concern some of a budget's tasks, or all."""
    episodes = configuration.evaluation.episodes
    steps = ", ".join(
        f"{configuration.tasks[task].max_steps} ({task_label(task)})"
        for task in tasks or configuration.budget.tasks
    )
    return f"N = {episodes} episode{'s' * (episodes > 1)} per evaluation of at most {steps} steps"


def lacking(campaign: Campaign) -> str:
    """How many of a budget's cells lack seeds, in a sentence for captions; empty where none does.

    The figures that put many cells together cannot mark each, so they say this.
    """
    grid = cells(campaign.configuration)
    missing = [len(campaign.runs(cell).missing) for cell in grid]
    if not any(missing):
        return ""
    runs = len(grid) * campaign.configuration.budget.seeds
    incomplete = sum(map(bool, missing))
    return (
        f"Seeds are missing: {incomplete} of {len(grid)} cells are incomplete, "
        f"{sum(missing)} of {runs} runs are not there."
    )


def describe_samples(campaign: Campaign) -> str:
    """M of a budget's SCORE: 1e8."""
    digits, _, exponent = f"{campaign.score_samples:.3e}".partition("e")
    return f"{float(digits):g}e{int(exponent)}"


def _score_title(campaign: Campaign) -> str:
    largest = max(campaign.configuration.budget.populations)
    return (
        f"SCORE (sample efficiency), mean ± SD over seeds, at population {largest} and each "
        f"method's best learning rate, with M = {describe_samples(campaign)};"
    )


def _means(
    number: int,
    title: str,
    entry: Callable[[Summary], Entry],
    campaign: Campaign,
    setting: str,
    methods: Sequence[str],
    values: int | None = None,
) -> Table:
    """A table whose entries are printed by `entry`; table `values` has the paper's means."""
    comparisons = compare(campaign, setting, values or number, methods)
    marks = _marks(each.here.incomplete for each in comparisons)
    lines = []
    for task in campaign.configuration.budget.tasks:
        row = [each for each in comparisons if each.task == task]
        ours = [_mark(entry(each.here), marks.get(each.here.incomplete)) for each in row]
        lines += _two_lines(task, ours, [entry(each.paper) for each in row])
    frame = pd.DataFrame([_flat(each) for each in comparisons])
    frame = frame.astype({"population": "Int64", "paper_population": "Int64"})
    columns = tuple(METHODS[method] for method in methods)
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
        number=number,
        caption=f"{title} {describe_budget(configuration)}",
        columns=columns,
        lines=tuple(lines),
        notes=(*incomplete, *_flattered(shown), *reference.CONTRADICTIONS.get(number, ())),
        frame=frame,
        configuration=configuration,
        sources=campaign.sources(cell for among in shown.values() for cell in among),
    )


def _flattered(shown: Mapping[tuple[str, str], Sequence[Cell]]) -> list[str]:
    """That a rule was chosen among more cells than NEAT, by the runs that are shown and tested."""
    rules = max((len(among) for (_, method), among in shown.items() if method in RULES), default=0)
    neat = max(
        (len(among) for (_, method), among in shown.items() if method not in RULES), default=0
    )
    if rules <= neat:
        return []
    return [
        f"A rule's cell is the best of up to {rules}, NEAT's of {neat}, chosen by the same seeds "
        "that are shown and tested: that alone lifts its mean and lowers its p-value. In a "
        "simulation of equal methods (normal outcomes, 30 seeds, the best of 4 cells against 1) "
        f"the test at {ALPHA} finds the rule higher in {CHOSEN_OF_FOUR:.0%} of cases."
    ]


def _marks(reasons: Iterable[str]) -> dict[str, str]:
    """A letter for each reason why a value is incomplete: (a) to (z), then (aa) and so on."""
    distinct = dict.fromkeys(reason for reason in reasons if reason)
    letters = len(ascii_lowercase)
    return {
        reason: f"({ascii_lowercase[i % letters] * (i // letters + 1)})"
        for i, reason in enumerate(distinct)
    }


def _mark(entry: Entry, mark: str | None) -> Entry:
    return Entry(f"{entry.text} {mark}", entry.emphasis) if mark else entry


def _two_lines(task: str, ours: Sequence[Entry], papers: Sequence[Entry]) -> list[Line]:
    return [
        Line(task_label(task), tuple(ours), is_paper=False),
        Line("paper", tuple(papers), is_paper=True),
    ]


def _flat(comparison: Comparison) -> dict[str, object]:
    return {
        "task": comparison.task,
        "method": comparison.method,
        **asdict(comparison.here),
        **{f"paper_{name}": value for name, value in asdict(comparison.paper).items()},
    }


def _fitness(summary: Summary) -> Entry:
    """324.34 ± 3.86, as Table 1 prints it."""
    return _mean_sd(summary, lambda value: f"{value:.2f}")


def _score(summary: Summary) -> Entry:
    """0.451 ± 0.0122: three significant figures, as in Table 2."""
    return _mean_sd(summary, lambda value: f"{value:#.3g}".rstrip("."))


def _mean_sd(summary: Summary, number: Callable[[float], str]) -> Entry:
    if math.isnan(summary.mean):
        return Entry(NOTHING)
    sd = NOTHING if math.isnan(summary.sd) else number(summary.sd)
    return Entry(f"{number(summary.mean)} ± {sd}", summary.rank)


def _setting(summary: Summary) -> Entry:
    """pop=300, lr=0.25, as Table 3 prints it."""
    if summary.population is None:
        return Entry(NOTHING)
    rate = "" if summary.learning_rate is None else f", lr={summary.learning_rate:g}"
    return Entry(f"pop={summary.population}{rate}")


def _p(p: float, decimals: int) -> Entry:
    """1.20e-8, bold below 0.05."""
    if math.isnan(p):
        return Entry(NOTHING)
    digits, exponent = f"{p:.{decimals}e}".split("e")
    return Entry(f"{digits}e{int(exponent)}", "best" if p < ALPHA else "")
