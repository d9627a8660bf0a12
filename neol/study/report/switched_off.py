"""Champions of the rules played again with plasticity switched off, in their held-out episodes.

Each plays the first episodes of its record again, so both returns are of the same episodes. The
champions are those of the cells that Tables 3 and 4 choose among: a whole grid would take many
times as long as all tables together.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd

from neol.base.files import write_atomically
from neol.champions.player import load_champion
from neol.study.campaign.grid import RESULTS, blocks
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import candidates
from neol.study.report.common import command_line

EPISODES = 10
"""Episodes of each champion. A cell of ten seeds gives 100 pairs, in 1 to 30 seconds."""
COLUMNS = ["task", "method", "population", "learning_rate", "seed", "episodes", "plastic", "fixed"]
"""Columns of the table; `plastic` and `fixed` are mean returns with plasticity and without."""


def switched_off(campaign: Campaign, results: Path = RESULTS) -> Iterator[tuple[object, ...]]:
    """Yield a row of `COLUMNS` for each run of a method with a rule; NaN if all episodes failed."""
    configuration = campaign.configuration
    shown = {
        cell
        for setting in ("table3", "table4")
        for among in candidates(configuration, setting).values()
        for cell in among
    }
    for block in blocks(configuration):
        cell = block.cell
        if cell not in shown or not configuration.methods[cell.method].learns:
            continue
        there = campaign.runs(cell).held_out
        for seed in (seed for seed in block.seeds if seed in there):
            player = load_champion(results / block.record, seed)
            seeds = player.held_out_seeds[:EPISODES]
            plastic = np.array(player.recorded_returns[:EPISODES])
            fixed = player.evaluate(seeds, plastic=False)
            both = np.isfinite(plastic) & np.isfinite(fixed)
            means = [returns[both].mean() if both.any() else np.nan for returns in (plastic, fixed)]
            place = cell.task, cell.method, cell.population, cell.learning_rate
            yield *place, seed, int(both.sum()), *means


def write_switched_off(campaign: Campaign, output: Path) -> None:
    """Write the rows of a budget as CSV."""
    table = pd.DataFrame(switched_off(campaign), columns=COLUMNS)
    write_atomically(output, table.to_csv(index=False).encode())


if __name__ == "__main__":
    command_line("neol.study.report.switched_off", __doc__, write_switched_off, output="the file")
