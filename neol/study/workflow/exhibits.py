"""The tables and figures of the workflow, each declared once.

The Snakefile, the report and the paper read here their files, the notebook and records that they
are made from, and their captions.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from neol.pictures.labels import task_label
from neol.spec.configuration import Configuration
from neol.spec.constants import Budget
from neol.study.campaign.grid import RESULTS, blocks
from neol.study.campaign.shown import two_by_two
from neol.study.campaign.variants import trials, variants
from neol.study.outcomes.chosen_cells import candidates

Target = Literal["tables", "numbers", "figures", "claims", "beyond"]
GRID = "grid"
"""Name of the records of all cells."""
LEDGER = "ledger"
"""Name of the same, with the records there are of the rules with weight mutation."""
TRIALS = "sensitivity study"
"""Name of the records of the sensitivity study."""


@dataclass(frozen=True, slots=True)
class Group:
    """Exhibits that `snakemake TARGET` makes together, with files of the same kinds."""

    target: Target
    title: str
    suffixes: tuple[str, ...]


TABLES = Group("tables", "Tables", ("tex", "csv", "json", "md"))
NUMBERS = Group("numbers", "Beside the paper's numbers", ("tex", "csv", "json", "md"))
FIGURES = Group("figures", "Figures", ("pdf", "png", "json", "csv"))
CLAIMS = Group("claims", "Claims", ("tex", "csv", "json", "md"))
BEYOND = Group("beyond", "Beyond the paper", ("pdf", "png", "json", "csv"))


@dataclass(frozen=True, slots=True)
class Exhibit:
    """A table or figure."""

    name: str
    """Stem of its files in the folder of figures."""
    group: Group
    notebook: str
    """Stem of the notebook that makes it."""
    reads: str
    """Records it needs: candidates of a setting in `chosen_cells`, `GRID`, `LEDGER` or `TRIALS`."""
    caption: str
    files: tuple[str, ...] = ()
    """Other inputs: patterns of the repository's files."""
    built: tuple[str, ...] = ()
    """Other inputs: what rules of the workflow write to its folder of `build/`."""
    task: str | None = None
    """The only task that it shows; it is omitted for a budget without this task."""


def heatmap(name: str, task: str, outcome: str) -> Exhibit:
    """Declare one of the paper's Figures 4 to 11: an outcome on a task over the whole grid."""
    number = name.removeprefix("figure")
    grid = "each population size, method and learning rate"
    caption = f"Figure {number}: {outcome} on {task_label(task)} for {grid}."
    return Exhibit(name, FIGURES, "heatmaps", GRID, caption, task=task)


# fmt: off
EXHIBITS = (
    Exhibit("table1", TABLES, "tables", reads="table3",
        caption="Table 1: best fitness of the final generation, mean and standard deviation "
        "over seeds, with the paper's values beneath."),
    Exhibit("table2", TABLES, "efficiency", reads="score",
        caption="Table 2: SCORE, the paper's measure of sample efficiency, at the largest "
        "population and each method's best learning rate."),
    Exhibit("table3", TABLES, "tables", reads="table3",
        caption="Table 3: the configurations that Tables 1 and 5 and Figure 2 show."),
    Exhibit("table4", TABLES, "ablation", reads="table4",
        caption="Table 4: the configurations that Table 7 and Figure 3 show."),
    Exhibit("table5", TABLES, "tables", reads="table3",
        caption="Table 5: p-values of the rank-sum test of final fitness, each rule against "
        "NEAT."),
    Exhibit("table6", TABLES, "efficiency", reads="score",
        caption="Table 6: p-values of the rank-sum test of SCORE, each rule against NEAT."),
    Exhibit("table7", TABLES, "ablation", reads="table4",
        caption="Table 7: the ablation, best fitness of the final generation against NEAT "
        "without weight mutation."),
    Exhibit("table8", TABLES, "ablation", reads="score",
        caption="Table 8: the ablation, SCORE against NEAT without weight mutation."),
    Exhibit("numbers1", NUMBERS, "agreement", reads="table3",
        caption="Table 1's numbers here and in the paper: differences with intervals, and which "
        "are significant."),
    Exhibit("numbers2", NUMBERS, "agreement", reads="score",
        caption="Table 2's numbers here and in the paper."),
    Exhibit("numbers7", NUMBERS, "agreement", reads="table4",
        caption="Table 7's numbers here and in the paper."),
    Exhibit("numbers8", NUMBERS, "agreement", reads="score",
        caption="Table 8's numbers here and in the paper."),
    Exhibit("figure2", FIGURES, "convergence", reads="table3",
        caption="Figure 2: best fitness over generations and its final values, the three rules "
        "and NEAT."),
    Exhibit("figure3", FIGURES, "convergence", reads="table4",
        caption="Figure 3: best fitness over generations and its final values, the three rules "
        "and NEAT without weight mutation."),
    heatmap("figure4", "cartpole", "mean final best fitness"),
    heatmap("figure5", "lunar_lander", "mean final best fitness"),
    heatmap("figure6", "hopper", "mean final best fitness"),
    heatmap("figure7", "bipedal_walker", "mean final best fitness"),
    heatmap("figure8", "cartpole", "mean SCORE"),
    heatmap("figure9", "lunar_lander", "mean SCORE"),
    heatmap("figure10", "hopper", "mean SCORE"),
    heatmap("figure11", "bipedal_walker", "mean SCORE"),
    Exhibit("claims", CLAIMS, "claims", reads=LEDGER,
        files=("paper/*.yaml", "paper/plan.md", "paper/frozen.txt"),
        caption="Claims: the questions that the paper's claims raise, each with its "
        "verdict, effect and interval."),
    Exhibit("beyond_effects", BEYOND, "beyond", reads=GRID,
        caption="Effect sizes: the difference of means between each method and NEAT, and NEAT "
        "(w/o), with intervals, beside the paper's."),
    Exhibit("beyond_curves", BEYOND, "convergence", reads="table3",
        caption="Differences over generations: the best fitness of each rule minus NEAT's, with "
        "intervals of the difference."),
    Exhibit("beyond_aggregates", BEYOND, "beyond", reads=GRID,
        caption="Aggregates: interquartile means of the tasks, and of several their mean, with "
        "stratified bootstrap intervals."),
    Exhibit("beyond_profiles", BEYOND, "beyond", reads=GRID,
        caption="Performance profiles: the share of runs that reach at least a return."),
    Exhibit("beyond_efficiency", BEYOND, "beyond", reads=GRID,
        caption="Efficiency: mean best-so-far fitness over equal evaluations and equal "
        "environment steps, beside SCORE."),
    Exhibit("beyond_selection", BEYOND, "beyond", reads=GRID,
        caption="Selection bias: the champion's training maximum beside its mean return in "
        "fresh episodes."),
    Exhibit("beyond_learning", BEYOND, "learning", reads=GRID, built=("switched_off.csv",),
        caption="Learning: how far weights move in each cell of a rule, and what switching "
        "plasticity off changes in the champions' return."),
    Exhibit("beyond_sensitivity", BEYOND, "beyond", reads=TRIALS,
        files=("config/sensitivity/*.yaml",),
        caption="Sensitivity: what some of the constants that the paper leaves open do to the "
        "champion's held-out return."),
)
# fmt: on
HEAT_MAPS = {each.name: each.task for each in EXHIBITS if each.task}
"""Exhibits that need a task's whole grid, with the task."""


def exhibits(budget: Budget, *targets: Target) -> list[Exhibit]:
    """Return the exhibits of some targets, or of all, whose task a budget has.

    Heat maps, those with a task, are omitted where a budget has only some cells of its grid.
    """
    return [
        each
        for each in EXHIBITS
        if (not targets or each.group.target in targets) and each.task in (None, *budget.grid_tasks)
    ]


def by_notebook(exhibits: Iterable[Exhibit]) -> dict[str, list[Exhibit]]:
    """Group exhibits by the notebook that makes them."""
    notebooks: dict[str, list[Exhibit]] = {}
    for each in exhibits:
        notebooks.setdefault(each.notebook, []).append(each)
    return notebooks


def records(configuration: Configuration, reads: str) -> list[Path]:
    """Return the records that an exhibit of a budget needs, below the results folder."""
    if reads == TRIALS:
        return [trial.record for name in variants() for trial in trials(configuration, name)]
    if reads in (GRID, LEDGER):
        further = two_by_two(configuration) if reads == LEDGER else []
        also = [block.record for each in further for block in blocks(each)]
        there = [record for record in also if (RESULTS / record).exists()]
        return [block.record for block in blocks(configuration)] + there
    cells = {cell for among in candidates(configuration, reads).values() for cell in among}
    return [block.record for block in blocks(configuration) if block.cell in cells]
