"""docs/episode-lengths.csv: how long episodes are in the records of the default budget.

`python -m benchmarks.episode_lengths` writes it; `neol.study.campaign.cost` predicts from it.
"""

import pandas as pd

from neol.base.files import write_atomically
from neol.spec.configuration import ROOT
from neol.study.campaign.cost import EPISODE_LENGTHS
from neol.study.campaign.grid import RESULTS, cells
from neol.study.campaign.shown import DEFAULT_BUDGET, select
from neol.study.outcomes.campaign_runs import Campaign

GENERATIONS = (1, 2, 5, 10, 20, 40, 60, 100, 200, 300, 400, 500)
"""Generations at which lengths are written, as far as a task's runs go."""


def episode_lengths(campaign: Campaign) -> pd.DataFrame:
    """Return a row for each task, method and some of the generations.

    `steps` is the mean number of steps of an evaluation in all generations until then, over all
    runs of the method.
    """
    found = []
    for cell in cells(campaign.configuration):
        rows = campaign.runs(cell).rows
        rows = rows[rows["generation"].isin(GENERATIONS)]
        steps = rows["env_steps"] / rows["evaluations"]
        found.append(rows[["generation"]].assign(task=cell.task, method=cell.method, steps=steps))
    keys = ["task", "method", "generation"]
    return pd.concat(found).groupby(keys, sort=False)["steps"].mean().reset_index()


def content() -> bytes:
    """Return the file's content, from the records in this repository."""
    table = episode_lengths(Campaign(select(DEFAULT_BUDGET), ROOT / RESULTS))
    head = "# Mean steps of an evaluation until a generation, from the records of the budget "
    text = f"{head}{DEFAULT_BUDGET}\n{table.to_csv(index=False, float_format='%.1f')}"
    return text.encode()


if __name__ == "__main__":
    write_atomically(EPISODE_LENGTHS, content())
