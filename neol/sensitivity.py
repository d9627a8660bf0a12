"""Sensitivity: the constants that the paper leaves open, changed one at a time.

config/sensitivity/ lists the variants and states the study's size; the workflow runs their trials.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from neol.campaign import RESULTS
from neol.errors import UserError
from neol.model import Model, Population, PositiveInt
from neol.overlay import Overlay
from neol.spec import CONFIG, Configuration, RunSpec, load_configuration

VARIANTS = CONFIG / "sensitivity" / "variants.yaml"
STUDY = CONFIG / "sensitivity" / "study.yaml"
BASELINE = "baseline"
FIRST_SEED = 1_000_000
"""Tuning seeds begin here, beyond those of every budget."""


class Study(Model):
    """How much a variant spends at most; a smaller budget's own size is less."""

    generations: PositiveInt
    population: Population
    seeds: PositiveInt


class Variant(Model):
    """Some constants changed, for the methods that they concern."""

    methods: tuple[str, ...]
    set: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Trial:
    """A task and method under a variant: one record."""

    variant: str
    task: str
    method: str
    spec: RunSpec
    """With the first of its seeds."""
    seeds: range
    record: Path


def study() -> Study:
    """The size that the file states."""
    overlay = Overlay()
    overlay.add_file(STUDY)
    return Study.model_validate(overlay.values, strict=False)


def variants() -> dict[str, Variant]:
    """Those that the file lists, the baseline first."""
    overlay = Overlay()
    overlay.add_file(VARIANTS)
    return {
        name: Variant.model_validate(content, strict=False)
        for name, content in overlay.values.items()
    }


def trials(configuration: Configuration, name: str) -> list[Trial]:
    """What a variant runs in a budget, for each of its tasks and methods."""
    budget, most = configuration.budget, study()
    if name not in variants():
        raise UserError(f'unknown variant "{name}" (allowed: {", ".join(variants())})')
    variant = variants()[name]
    changed = load_configuration(budget.name, variant.set)
    rate = budget.learning_rates[len(budget.learning_rates) // 2]
    seeds = range(FIRST_SEED, FIRST_SEED + min(budget.seeds, most.seeds))
    return [
        Trial(
            variant=name,
            task=task,
            method=method,
            spec=changed.run_spec(
                task=task,
                method=method,
                population=min(*budget.populations, most.population),
                learning_rate=rate if changed.methods[method].learns else None,
                generations=min(budget.generations_of(task), most.generations),
                seed=seeds[0],
            ),
            seeds=seeds,
            record=folder(budget.name, name) / f"{task}_{method}.parquet",
        )
        for task in budget.tasks
        for method in variant.methods
    ]


def folder(budget: str, name: str) -> Path:
    """Where a variant's records lie: results/smoke/sensitivity/beta-0.001."""
    return RESULTS / budget / "sensitivity" / re.sub(r"[^\w.]+", "-", name)
