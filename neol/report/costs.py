"""What a budget took: runs, evaluations, environment steps, core-hours."""

import pandas as pd

from neol.analysis.runs import Campaign
from neol.campaign import cells

SECONDS_IN_AN_HOUR = 3600
COSTS = ("runs", "evaluations", "env_steps", "core_hours")


def costs(campaign: Campaign) -> pd.DataFrame:
    """A row for each of a budget's tasks, by its name, and "all" of them; columns are `COSTS`.

    Environment steps are those of training. Core-hours are CPU time, held-out episodes included,
    worker processes not.
    """
    rows = []
    for cell in cells(campaign.configuration):
        runs = campaign.runs(cell)
        spent = runs.rows.groupby("seed")[["evaluations", "env_steps"]].max().sum()
        hours = sum(runs.cpu_seconds.values()) / SECONDS_IN_AN_HOUR
        rows.append(
            (cell.task, len(runs.cpu_seconds), spent["evaluations"], spent["env_steps"], hours)
        )
    by_task = pd.DataFrame(rows, columns=["task", *COSTS]).groupby("task", sort=False).sum()
    by_task.loc["all"] = by_task.sum()
    counts = ["runs", "evaluations", "env_steps"]
    return by_task.astype(dict.fromkeys(counts, "int64"))
