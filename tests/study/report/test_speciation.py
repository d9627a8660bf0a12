"""How many species a method's populations had."""

from dataclasses import astuple
from statistics import mean, stdev

import pandas as pd

from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import RESULTS, Cell
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.report.speciation import (
    crowded_cells,
    species_by_cell,
    species_by_task,
    without_weights,
)

COLUMNS = ["task", "method", "population", "learning_rate", "species", "crowded"]


def test_every_cell_with_runs_has_a_row(campaign: Campaign) -> None:
    found = species_by_cell(campaign)
    assert list(found.columns) == COLUMNS
    assert species_by_task(found)[0].startswith("CartPole: BCM ")


def test_without_weights_the_same_seeds_are_compared() -> None:
    shipped = Campaign(load_configuration("evidence"), RESULTS)
    cell = Cell("lunar_lander", "bcm", 300, 0.25)
    rows = [(*astuple(cell), 144.5, 0.54), ("lunar_lander", "oja", 300, 0.25, 150, 0.6)]
    (sentence,) = without_weights(shipped, pd.DataFrame(rows, columns=COLUMNS))
    ends = [end for seed, end in shipped.runs(cell).final_best.items() if seed < 10]
    assert sentence.startswith("BCM at rate 0.25 has ")
    assert sentence.endswith(f"instead of {mean(ends):.0f} ± {stdev(ends):.0f} (10 seeds)")
    assert without_weights(shipped, pd.DataFrame([], columns=COLUMNS)) == []
    shorter = load_configuration("evidence", ["budget.generations=60", "budget.records_of={}"])
    unlike = Campaign(shorter, RESULTS, partial=True)
    assert without_weights(unlike, pd.DataFrame(rows, columns=COLUMNS)) == []


def test_cells_whose_species_fill_the_population_are_named() -> None:
    rows = [
        ("lunar_lander", "bcm", 300, 0.25, 144.5, 0.54),
        ("lunar_lander", "bcm", 300, 0.025, 8.4, 0.0),
        ("lunar_lander", "neat", 300, None, 1.2, 0.0),
    ]
    species = pd.DataFrame(rows, columns=COLUMNS)
    assert crowded_cells(species) == "Lunar Lander, P = 300: BCM at rate 0.25 (144 species)"
    assert crowded_cells(species[1:]) == ""
    assert species_by_task(species) == ["Lunar Lander: BCM 8.4 to 144, NEAT 1.2."]
