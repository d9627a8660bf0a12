"""Sentences on a budget for captions: its size, and the runs that are missing."""

from collections.abc import Mapping, Sequence

from neol.pictures.labels import listed, task_label
from neol.spec.configuration import PAPER_BUDGET, Configuration, load_configuration
from neol.spec.constants import Budget
from neol.study.campaign.grid import cells
from neol.study.campaign.shown import chosen_tasks, differs_from_default, with_tasks
from neol.study.campaign.variants import BASELINE, trials
from neol.study.outcomes.campaign_runs import Campaign


def describe_budget(configuration: Configuration, tasks: Sequence[str] = ()) -> str:
    """Describe a budget and its reading in a few sentences, for some of its tasks or all."""
    budget = configuration.budget
    sentence = (
        f"Budget {describe_name(budget)}: G = {describe_generations(budget, tasks)} generations, "
        f"{budget.seed_count} seeds, {describe_episodes(configuration, tasks)}."
    )
    if is_part_of_papers(configuration):
        sentence += f" A part of the paper's budget: {describe_part(budget)}."
    elif not is_papers(configuration):
        sentence += " Reduced budget: not the paper's."
    return f"{sentence} {describe_reading(configuration)}"


def describe_part(budget: Budget) -> str:
    """Describe which part of the paper's budget another one shows: 10 of 30 seeds, P = 300."""
    papers = load_configuration(PAPER_BUDGET).budget
    populations = ", ".join(map(str, budget.populations))
    return f"{budget.seed_count} of {papers.seed_count} seeds, P = {populations}"


def describe_reading(configuration: Configuration) -> str:
    """Name the reading and each constant that differs from the default reading, in a sentence."""
    changed = ", ".join(
        f"{key} = {here} instead of {default}"
        for key, (here, default) in differs_from_default(configuration).items()
    )
    return f"Reading {configuration.reading}{f': {changed}' if changed else ''}."


def describe_name(budget: Budget) -> str:
    """Return a budget's name, and its tasks if they are not all: paper, CartPole only."""
    tasks = chosen_tasks(budget)
    return f"{budget.name}, {listed(map(task_label, tasks))} only" if tasks else budget.name


def is_papers(configuration: Configuration) -> bool:
    """Whether a budget is as large as the paper's, for any of its tasks."""
    paper = load_configuration(PAPER_BUDGET, reading=configuration.reading)
    return configuration == with_tasks(paper, configuration.budget.tasks)


def is_part_of_papers(configuration: Configuration) -> bool:
    """Whether all runs of a budget are among those of the paper's budget."""
    budget = configuration.budget
    return all(budget.records_of.get(task) == PAPER_BUDGET for task in budget.tasks)


def describe_generations(budget: Budget, tasks: Sequence[str] = ()) -> str:
    """Describe G of some tasks or all: 500, or 50 (CartPole, LunarLander), 6 (Hopper)."""
    return by_task({task: str(budget.generations_of(task)) for task in tasks or budget.tasks})


def describe_episodes(configuration: Configuration, tasks: Sequence[str] = ()) -> str:
    """Describe the number and length of episodes, for some of a budget's tasks or all."""
    episodes = configuration.evaluation.episodes
    steps = by_task(
        {
            task: str(configuration.tasks[task].max_steps)
            for task in tasks or configuration.budget.tasks
        }
    )
    return f"N = {episodes} episode{'s' * (episodes > 1)} per evaluation of at most {steps} steps"


def describe_samples(campaign: Campaign, tasks: Sequence[str] = ()) -> str:
    """Describe M of the SCORE of some tasks or all: 1e8, or 1e7 (CartPole), 1.2e6 (Hopper)."""
    return by_task(
        {
            task: _scientific(campaign.score_samples(task))
            for task in tasks or campaign.configuration.budget.tasks
        }
    )


def lacking(campaign: Campaign) -> str:
    """Return a sentence on cells that lack seeds, for captions; empty if none does.

    Figures of many cells cannot mark each incomplete one, so they print this sentence.
    """
    grid = cells(campaign.configuration)
    missing = [len(campaign.runs(cell).missing) for cell in grid]
    if not any(missing):
        return ""
    runs = len(grid) * campaign.configuration.budget.seed_count
    incomplete = sum(map(bool, missing))
    return (
        f"Seeds are missing: {incomplete} of {len(grid)} cells are incomplete, "
        f"{sum(missing)} of {runs} runs are not there."
    )


def by_task(values: Mapping[str, str]) -> str:
    """Return the value that all tasks share, or each value with its tasks."""
    if len(set(values.values())) == 1:
        return next(iter(values.values()))
    return ", ".join(
        f"{value} ({', '.join(task_label(task) for task in values if values[task] == value)})"
        for value in dict.fromkeys(values.values())
    )


def _scientific(number: float) -> str:
    digits, _, exponent = f"{number:.3e}".partition("e")
    return f"{float(digits):g}e{int(exponent)}"


def describe_trials(configuration: Configuration) -> str:
    """Describe the runs of the sensitivity study in a sentence, for captions."""
    first, *others = trials(configuration, BASELINE)
    rate = max(trial.spec.plasticity.learning_rate for trial in (first, *others))
    generations = {trial.task: str(trial.spec.generations) for trial in (first, *others)}
    return (
        f"Sensitivity runs of budget {configuration.budget.name}: G = {by_task(generations)} "
        f"generations, population {first.spec.population}, learning rate {rate:g}, "
        f"{len(first.seeds)} seeds that no table uses."
    )
