"""Sensitivity: the constants that the paper leaves open, changed one at a time.

config/sensitivity/ lists the variants and the study's size; the workflow runs their trials.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from neol.base.errors import UserError, hint
from neol.spec.configuration import CONFIG, Configuration, load_configuration
from neol.spec.run_spec import RunSpec
from neol.spec.sources import Overlay
from neol.spec.types import MethodName, Model, PopulationSize, PositiveInt, Several, TaskName
from neol.study.campaign.grid import home

VARIANTS = CONFIG / "sensitivity" / "variants.yaml"
STUDY = CONFIG / "sensitivity" / "study.yaml"
BASELINE = "baseline"
FIRST_SEED = 1_000_000
"""First seed of the study, beyond those of every budget."""


class Study(Model):
    """Tasks and largest size of a variant's runs; a smaller budget uses its own size."""

    tasks: Several[TaskName]
    generations: PositiveInt
    population: PopulationSize
    seeds: PositiveInt


class Variant(Model):
    """Changed constants, and the methods that they concern."""

    methods: Several[MethodName]
    set: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Trial:
    """A variant of a task and method: one record."""

    task: str
    method: str
    spec: RunSpec
    """Specification with the first seed."""
    seeds: range
    record: Path


def study() -> Study:
    """Return the size of the study from its file. Raises UserError for an invalid file."""
    return Overlay.of(STUDY).parse(Study)


def variants() -> dict[str, Variant]:
    """Return the listed variants, the baseline first. Raises UserError for an invalid file."""
    return Overlay.of(VARIANTS).parse(dict[str, Variant])


def trials(configuration: Configuration, name: str) -> list[Trial]:
    """Return a variant's trials in a budget, for each of its methods and the study's tasks.

    There are none if the variant's constants are those of the budget's reading, or if the budget
    has none of these tasks.
    """
    budget, most = configuration.budget, study()
    known = variants()
    if name not in known:
        raise UserError(f'unknown variant "{name}"{hint(name, known)}')
    variant = known[name]
    try:
        plain, changed = (
            load_configuration(budget.name, overrides, reading=configuration.reading)
            for overrides in ((), variant.set)
        )
    except UserError as error:
        raise UserError(f"{VARIANTS.parent.name}/{VARIANTS.name}: {name}.set: {error}") from None
    if name != BASELINE and changed == plain:
        return []
    learning_rate = budget.learning_rates[len(budget.learning_rates) // 2]
    return [
        Trial(
            task=task,
            method=method,
            spec=changed.run_spec(
                task=task,
                method=method,
                population=min(*budget.populations_of(task), most.population),
                learning_rate=learning_rate if changed.methods[method].learns else None,
                generations=min(budget.generations_of(task), most.generations),
                seed=FIRST_SEED,
            ),
            seeds=range(FIRST_SEED, FIRST_SEED + min(len(budget.seeds_of(task)), most.seeds)),
            record=_variant_folder(configuration, name) / f"{task}_{method}.parquet",
        )
        for task in budget.tasks
        if task in most.tasks
        for method in variant.methods
    ]


def _variant_folder(configuration: Configuration, name: str) -> Path:
    """Return a variant's folder below the results folder: .../smoke/sensitivity/beta-0.001."""
    return home(configuration) / "sensitivity" / re.sub(r"[^\w.]+", "-", name)
