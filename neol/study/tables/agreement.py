"""The paper's printed numbers beside ours, with tests of whether both have one distribution.

Means are compared by Welch's interval, standard deviations by F; the paper's side is what it prints
for its 30 seeds. The tests of a table are corrected for their number (Holm).
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from neol.pictures.labels import method_label, task_label, three_figures, with_interval
from neol.study.campaign.methods import challengers
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import SETTINGS, candidates
from neol.study.outcomes.contrasts import Moments, difference, sd_p, sd_ratio
from neol.study.outcomes.movement import NEAR_CONTROL_NOTE
from neol.study.outcomes.paper_numbers import PAPER_SEEDS
from neol.study.outcomes.statistics import ALPHA, holm
from neol.study.output.captions import describe_budget, describe_samples
from neol.study.tables import formats
from neol.study.tables.summary import OursAndPapers, OwnSummary, compare
from neol.study.tables.table import Entry, Line, Table

COLUMNS = (
    "Here",
    "Paper",
    "Here - paper [95%]",
    "SD here / paper [95%]",
    "Differs",
)


def numbers1(campaign: Campaign) -> Table:
    """Compare Table 1's numbers."""
    return _agreement(
        1, campaign, "table3", SETTINGS["table3"].methods(campaign.configuration.budget)
    )


def numbers2(campaign: Campaign) -> Table:
    """Compare Table 2's numbers."""
    return _agreement(2, campaign, "score", (*challengers(campaign.configuration.budget), "neat"))


def numbers7(campaign: Campaign) -> Table:
    """Compare Table 7's numbers."""
    return _agreement(
        7, campaign, "table4", SETTINGS["table4"].methods(campaign.configuration.budget)
    )


def numbers8(campaign: Campaign) -> Table:
    """Compare Table 8's numbers."""
    return _agreement(
        8, campaign, "score", (*challengers(campaign.configuration.budget), "neat_wo")
    )


def differing(table: Table) -> str:
    """Say how many of a table's numbers differ significantly from the paper's."""
    frame = table.frame
    compared = int(frame[["p_mean", "p_sd"]].notna().sum().sum())
    differ = {what: frame["differs"].str.contains(what).sum() for what in ("mean", "SD")}
    return (
        f"Of {compared} numbers, {differ['mean']} means and {differ['SD']} standard deviations "
        "differ significantly from the paper's, after Holm's correction."
    )


def _agreement(number: int, campaign: Campaign, setting: str, methods: Sequence[str]) -> Table:
    compared = compare(campaign, setting, number, methods)
    frame = pd.DataFrame([_row(each) for each in compared])
    tests = holm([*frame["p_mean"], *frame["p_sd"]]).reshape(2, -1)
    frame["p_mean_holm"], frame["p_sd_holm"] = tests
    frame["differs"] = [
        " and ".join(what for what, p in zip(("mean", "SD"), both, strict=True) if p < ALPHA)
        for both in tests.T
    ]
    marks = formats.marks(frame["incomplete"])
    number_format, outcome = formats.fitness, "best final-generation fitness"
    if setting == "score":
        number_format, outcome = formats.score, f"SCORE, with M = {describe_samples(campaign)}"
    lines = [
        Line(
            f"{task_label(each.task)}, {method_label(each.method)}{_rate(each.here)}",
            (
                formats.marked(
                    number_format(each.here),
                    marks.get(each.here.incomplete),
                    near_control=each.here.near_control,
                ),
                number_format(each.paper),
                _interval(row["difference"], row["low"], row["high"]),
                _interval(row["sd_ratio"], row["sd_low"], row["sd_high"]),
                Entry(row["differs"], "best") if row["differs"] else Entry("--"),
            ),
            is_beneath=False,
        )
        for each, row in zip(compared, frame.to_dict("records"), strict=True)
    ]
    among = [cell for some in candidates(campaign.configuration, setting).values() for cell in some]
    little = [NEAR_CONTROL_NOTE] if frame["near_control"].any() else []
    return Table(
        name=f"numbers{number}",
        number=f"{number}a",
        caption=(
            f"The numbers of the paper's Table {number} ({outcome}) beside ours: the "
            "difference of means with Welch's interval, and the ratio of standard deviations with "
            "an F interval, which assumes normal outcomes. The last column names what differs at "
            f"level {ALPHA} after Holm's correction over this table. A rule's learning rate "
            "follows its name. "
            f"{describe_budget(campaign.configuration)}"
        ),
        columns=COLUMNS,
        lines=tuple(lines),
        notes=(*(f"{mark} {reason}." for reason, mark in marks.items()), *little),
        frame=frame,
        configuration=campaign.configuration,
        sources=campaign.sources(cell for cell in among if cell.method in methods),
    )


def _row(each: OursAndPapers) -> dict[str, object]:
    """Return the row of a method on a task: both sides' numbers and how they differ."""
    here = Moments(each.here.seeds, each.here.mean, each.here.sd)
    paper = Moments(PAPER_SEEDS, each.paper.mean, each.paper.sd)
    gap, ratio = difference(here, paper), sd_ratio(here, paper)
    low, high = gap.interval()
    return {
        "task": each.task,
        "method": each.method,
        "population": each.here.population,
        "learning_rate": each.here.learning_rate,
        "seeds": each.here.seeds,
        "mean": here.mean,
        "sd": here.sd,
        "paper_mean": paper.mean,
        "paper_sd": paper.sd,
        "difference": gap.value,
        "low": low,
        "high": high,
        "p_mean": gap.p(),
        "sd_ratio": ratio.value,
        "sd_low": ratio.low,
        "sd_high": ratio.high,
        "p_sd": sd_p(here, paper),
        "near_control": each.here.near_control,
        "incomplete": each.here.incomplete,
    }


def _rate(here: OwnSummary) -> str:
    return "" if here.learning_rate is None else f", rate {here.learning_rate:g}"


def _interval(value: float, low: float, high: float) -> Entry:
    if np.isnan([low, high]).any():
        return Entry(three_figures(value))
    return Entry(with_interval(value, low, high))
