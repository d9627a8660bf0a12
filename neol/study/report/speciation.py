"""How many species the populations had, which decides what speciation did to a method's runs."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import astuple, fields
from statistics import mean, stdev
from typing import Any

import pandas as pd

from neol.pictures.labels import listed, method_label, task_label
from neol.spec.configuration import PAPER_BUDGET, load_configuration
from neol.study.campaign.grid import RESULTS, Cell, cells
from neol.study.campaign.methods import shown_methods
from neol.study.outcomes.campaign_runs import Campaign

CROWDED = 0.5
"""Share of generations above which a cell counts as crowded."""
WITHOUT_WEIGHTS = "neat.weight_coefficient=0.0"
"""The change of a reading under which weights do not count in the distance between genomes."""


def species_by_cell(campaign: Campaign) -> pd.DataFrame:
    """Return a row for each cell with runs: its place in the grid, and means over generations.

    `species` is their number, `crowded` the share of generations in which the places that every
    species keeps (`places_kept`) fill the population.
    """
    kept = campaign.configuration.neat.places_kept
    rows = []
    order = shown_methods(campaign.configuration.budget)
    shown = [cell for cell in cells(campaign.configuration) if cell.method in order]
    for cell in sorted(shown, key=lambda cell: order.index(cell.method)):
        species = campaign.runs(cell).rows["species"]
        if len(species):
            crowded = species * kept >= cell.population
            rows.append((*astuple(cell), species.mean(), crowded.mean()))
    places = [field.name for field in fields(Cell)]
    return pd.DataFrame(rows, columns=[*places, "species", "crowded"])


def species_by_task(species: pd.DataFrame) -> list[str]:
    """Say for each task how many species each method had on average, as a range over its cells."""
    return [
        f"{task_label(str(task))}: "
        + ", ".join(
            f"{method_label(str(method))} {_range(some['species'])}"
            for method, some in rows.groupby("method", sort=False)
        )
        + "."
        for task, rows in species.groupby("task", sort=False)
    ]


def crowded_cells(species: pd.DataFrame) -> str:
    """Name the cells that are crowded in most generations; empty if there are none."""
    return "; ".join(
        f"{task_label(str(task))}, P = {population}: {listed(map(_named, rows.to_dict('records')))}"
        for (task, population), rows in _crowded(species).groupby(
            ["task", "population"], sort=False
        )
    )


def without_weights(campaign: Campaign, species: pd.DataFrame) -> list[str]:
    """Say how crowded cells end where weights do not count in the distance between genomes.

    It compares the seeds that have runs of both kinds at the paper's budget, at least two;
    docs/scaling.md has the plan of these runs.
    """
    reading = f"{campaign.configuration.reading}+{WITHOUT_WEIGHTS}"
    configuration = load_configuration(PAPER_BUDGET, reading=reading)
    other, known = Campaign(configuration, RESULTS, partial=True), cells(configuration)
    sentences = []
    for row in _crowded(species).to_dict("records"):
        cell = Cell(row["task"], row["method"], row["population"], row["learning_rate"])
        lengths = {
            each.budget.generations_of(cell.task)
            for each in (configuration, campaign.configuration)
        }
        if cell not in known or len(lengths) > 1:
            continue
        here, there = campaign.runs(cell).final_best, other.runs(cell).final_best
        seeds = sorted(here.keys() & there.keys())
        if len(seeds) < 2:
            continue
        count = other.runs(cell).rows["species"].mean()
        sentences.append(
            f"{method_label(cell.method)} at rate {cell.learning_rate:g} has {_rounded(count)} "
            f"species and ends at {_moments(there, seeds)} instead of {_moments(here, seeds)} "
            f"({len(seeds)} seeds)"
        )
    return sentences


def _crowded(species: pd.DataFrame) -> pd.DataFrame:
    return species[species["crowded"] > CROWDED]


def _moments(values: Mapping[int, float], seeds: Sequence[int]) -> str:
    each = [values[seed] for seed in seeds]
    return f"{mean(each):.0f} ± {stdev(each):.0f}"


def _named(row: Mapping[Hashable, Any]) -> str:
    rate = row["learning_rate"]
    at_rate = "" if pd.isna(rate) else f" at rate {rate:g}"
    return f"{method_label(str(row['method']))}{at_rate} ({row['species']:.0f} species)"


def _range(values: "pd.Series[float]") -> str:
    low, high = map(_rounded, (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def _rounded(value: float) -> str:
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}"
