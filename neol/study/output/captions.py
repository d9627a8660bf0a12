"""Sentences on a budget for captions: its size, and the runs that are missing."""

from collections.abc import Mapping, Sequence

from neol.pictures.labels import listed, task_label
from neol.spec.configuration import PAPER_BUDGET, Configuration, load_configuration
from neol.spec.constants import Budget
from neol.study.campaign.grid import cells
from neol.study.campaign.shown import chosen_tasks, differs_from_default
from neol.study.campaign.variants import BASELINE, trials
from neol.study.outcomes.campaign_runs import Campaign

PAPERS = "the paper's budget"
REDUCED = "reduced budget: not the paper's"


def describe_budget(configuration: Configuration, tasks: Sequence[str] = ()) -> str:
    """Describe a budget and its reading in a few sentences, for some of its tasks or all."""
    budget = configuration.budget
    sentence = (
        f"Budget {describe_name(budget)}: G = {describe_generations(budget, tasks)} generations, "
        f"{describe_seeds(budget, tasks)} seeds, {describe_episodes(configuration, tasks)}."
    )
    sizes = {task: describe_size(configuration, task) for task in tasks or budget.tasks}
    if set(sizes.values()) != {PAPERS}:
        said = by_task(sizes)
        sentence += f" {said[0].upper()}{said[1:]}."
    return f"{sentence} {describe_reading(configuration)}"


def describe_size(configuration: Configuration, task: str) -> str:
    """Say how large a budget is for a task: the paper's, a part of the paper's, or reduced."""
    of_paper = load_configuration(PAPER_BUDGET, reading=configuration.reading)
    here, papers = configuration.budget, of_paper.budget
    within = (
        configuration == of_paper.model_copy(update={"budget": here})
        and here.generations_of(task) == papers.generations_of(task)
        and set(here.seeds_of(task)) <= set(papers.seeds_of(task))
        and set(here.populations_of(task)) <= set(papers.populations_of(task))
        and set(here.learning_rates) <= set(papers.learning_rates)
        and set(here.methods) <= set(papers.methods)
    )
    if not within:
        return REDUCED
    return f"a part of {PAPERS}: {part}" if (part := describe_part(here, task)) else PAPERS


def describe_part(budget: Budget, task: str) -> str:
    """Describe which part of the paper's runs of a task a budget has: 10 of 30 seeds, P = 300.

    Empty for all of them.
    """
    papers = load_configuration(PAPER_BUDGET).budget
    parts = []
    if (seeds := budget.seeds_of(task)) != (all_seeds := papers.seeds_of(task)):
        parts.append(f"{len(seeds)} of {len(all_seeds)} seeds")
    if (populations := budget.populations_of(task)) != papers.populations_of(task):
        parts.append(f"P = {', '.join(map(str, populations))}")
    if (part := budget.configurations_of(task)) != "grid":
        tables = {"tables": "Tables 3 and 4", "table4": "Table 4"}[part]
        parts.append(f"the configurations of {tables}")
    elif (rates := budget.learning_rates) != papers.learning_rates:
        parts.append(f"learning rates {', '.join(f'{rate:g}' for rate in rates)}")
    return ", ".join(parts)


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
    """Whether a budget is as large as the paper's for all of its tasks."""
    tasks = configuration.budget.tasks
    return all(describe_size(configuration, task) == PAPERS for task in tasks)


def describe_generations(budget: Budget, tasks: Sequence[str] = ()) -> str:
    """Describe G of some tasks or all: 500, or 50 (CartPole, LunarLander), 6 (Hopper)."""
    return by_task({task: str(budget.generations_of(task)) for task in tasks or budget.tasks})


def describe_seeds(budget: Budget, tasks: Sequence[str] = ()) -> str:
    """Describe the number of seeds for some of a budget's tasks or all, as G."""
    return by_task({task: str(len(budget.seeds_of(task))) for task in tasks or budget.tasks})


def describe_populations(budget: Budget) -> str:
    """Describe the population sizes: 50, 100, or 50, 100 (CartPole), 100 (Hopper)."""
    return by_task(
        {task: ", ".join(map(str, budget.populations_of(task))) for task in budget.tasks}
    )


def describe_largest_population(budget: Budget) -> str:
    """Describe the largest population size: 300, or 300 (CartPole), 100 (Hopper)."""
    return by_task({task: str(max(budget.populations_of(task))) for task in budget.tasks})


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
    budget = campaign.configuration.budget
    runs = sum(len(budget.seeds_of(cell.task)) for cell in grid)
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
    planned = trials(configuration, BASELINE)
    if not planned:
        return "The sensitivity study has none of the tasks that are shown."
    rate = max(trial.spec.plasticity.learning_rate for trial in planned)
    generations = by_task({trial.task: str(trial.spec.generations) for trial in planned})
    population = by_task({trial.task: str(trial.spec.population) for trial in planned})
    seeds = by_task({trial.task: str(len(trial.seeds)) for trial in planned})
    return (
        f"Sensitivity runs of budget {configuration.budget.name}: G = {generations} "
        f"generations, population {population}, learning rate {rate:g}, "
        f"{seeds} seeds that no table uses."
    )
