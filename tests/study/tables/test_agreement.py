"""The paper's numbers beside ours, against SciPy's tests of summaries and plain arithmetic."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from neol.spec.configuration import ROOT
from neol.study.campaign.grid import RESULTS, Cell
from neol.study.campaign.reference import REFERENCE
from neol.study.campaign.shown import select
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.statistics import holm
from neol.study.tables.agreement import differing, numbers1, numbers2, numbers7, numbers8
from neol.study.tables.paper_tables import table1, table2, table7, table8
from neol.study.tables.table import Table
from tests.helpers.made_up import configuration, write_campaign

PAIRS = {numbers1: table1, numbers2: table2, numbers7: table7, numbers8: table8}


@pytest.mark.parametrize("make", PAIRS)
def test_each_printed_number_of_shipped_records_a_second_time(
    make: Callable[[Campaign], Table],
) -> None:
    """Every difference and p-value of `demo`, from the tables' own files and the paper's CSV."""
    campaign = Campaign(select("demo"), ROOT / RESULTS)
    found = make(campaign).frame.set_index(["task", "method"])
    ours = PAIRS[make](campaign).frame.set_index(["task", "method"])
    papers = pd.read_csv(REFERENCE / "tables.csv")
    papers = papers[papers["table"] == int(make.__name__.removeprefix("numbers"))]
    papers = papers.set_index(["task", "column"])
    assert len(found) == 8
    for place, row in found.iterrows():
        mean, sd, seeds = ours.loc[place, ["mean", "sd", "seeds"]]
        paper_mean, paper_sd = papers.loc[place, ["value", "sd"]]
        assert row["difference"] == pytest.approx(mean - paper_mean)
        if sd and paper_sd:
            welch = stats.ttest_ind_from_stats(
                mean, sd, seeds, paper_mean, paper_sd, 30, equal_var=False
            )
            assert row["p_mean"] == pytest.approx(welch.pvalue)
            tail = stats.f.cdf(sd**2 / paper_sd**2, seeds - 1, 29)
            assert row["p_sd"] == pytest.approx(2 * min(tail, 1 - tail), rel=1e-6, abs=1e-12)
    adjusted = holm([*found["p_mean"], *found["p_sd"]])
    assert (adjusted < 0.05).sum() == sum(
        len(each.split(" and ")) for each in found["differs"] if each
    )


def test_the_papers_own_numbers_differ_in_nothing(tmp_path: Path) -> None:
    """Thirty seeds with the mean and deviation that the paper prints for NEAT on Hopper."""
    constants = configuration(tasks=("hopper",), seeds=30)
    shape = np.linspace(-1, 1, 30)
    values = 2680.22 + 603.53 * shape / shape.std(ddof=1)
    cells = [Cell("hopper", "neat", population, None) for population in (6, 12)]
    write_campaign(tmp_path, constants, dict.fromkeys(cells, values.tolist()))
    table = numbers1(Campaign(constants, tmp_path))
    row = table.frame.set_index("method").loc["neat"]
    assert row[["difference", "sd_ratio", "p_mean", "p_sd"]].tolist() == pytest.approx([0, 1, 1, 1])
    assert row["differs"] == ""
    text = table.markdown()
    assert re.search(r"^\| Hopper, NEAT \|.* \| -- \|$", text, re.MULTILINE)
    assert re.search(
        r"^\| Hopper, BCM, rate 0.0\d+ \|.* \| \*\*mean and SD\*\* \|$", text, re.MULTILINE
    )
    assert table.frame.set_index("method").loc["bcm", "differs"] == "mean and SD"
    assert differing(table) == (
        "Of 8 numbers, 3 means and 3 standard deviations differ significantly from the paper's, "
        "after Holm's correction."
    )


def test_no_record_is_no_difference(tmp_path: Path) -> None:
    table = numbers2(Campaign(configuration(), tmp_path))
    assert set(table.frame["differs"]) == {""}
    assert differing(table).startswith("Of 0 numbers, 0 means")
