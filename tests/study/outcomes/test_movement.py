"""Movement of weights, by hand, and of shipped records a second time."""

import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from scipy import stats

from neol.spec.configuration import ROOT
from neol.spec.readings import DEFAULT_READING
from neol.study.campaign.grid import RESULTS, Cell, cells
from neol.study.campaign.shown import select
from neol.study.outcomes.campaign_runs import Campaign, CellRuns
from neol.study.outcomes.movement import (
    NEAR_CONTROL,
    describe_learning,
    is_near_control,
    learning,
    movement,
    movements,
    read_switched_off,
)
from neol.study.outcomes.outcomes import gather
from tests.helpers.made_up import configuration, write_campaign

OJA = Cell("cartpole", "oja", 12, 0.25)
NEAT = Cell("cartpole", "neat", 12, None)


class Moved(Campaign):
    """Runs whose weights move by so much in each evaluation."""

    change = 0.04

    def runs(self, cell: Cell) -> CellRuns:
        runs = super().runs(cell)
        return replace(runs, rows=runs.rows.assign(weight_change_mean=self.change))


def moved(folder: Path, change: float, *, write_back: bool = True) -> Moved:
    constants = configuration(generations=3)
    plasticity = constants.plasticity.model_copy(update={"write_back": write_back})
    constants = constants.model_copy(update={"plasticity": plasticity})
    write_campaign(folder, constants, {})
    campaign = Moved(constants, folder)
    campaign.change = change
    return campaign


def test_a_weight_moves_once_a_generation(tmp_path: Path) -> None:
    """Three generations of 0.04 are 0.12 initial standard deviations; of 0.03, less than 0.1."""
    far = moved(tmp_path, 0.04)
    assert movement(far, OJA).per_evaluation == pytest.approx(0.04)
    assert movement(far, OJA).over_run == pytest.approx(0.12)
    assert not is_near_control(far, OJA)
    assert is_near_control(moved(tmp_path, 0.03), OJA)


def test_without_write_back_nothing_adds_up(tmp_path: Path) -> None:
    campaign = moved(tmp_path, 0.04, write_back=False)
    assert movement(campaign, OJA).over_run == pytest.approx(0.04)


def test_a_method_without_a_rule_is_no_rule_near_control(tmp_path: Path) -> None:
    campaign = moved(tmp_path, 0.0)
    assert is_near_control(campaign, OJA)
    assert not is_near_control(campaign, NEAT)
    assert {cell.method for cell in gather(campaign).near_control} == {"bcm", "hebb", "oja"}


def test_no_runs_are_not_near_control(tmp_path: Path) -> None:
    campaign = Campaign(configuration(), tmp_path)
    assert not is_near_control(campaign, OJA)
    assert movements(campaign)["movement_over_run"].isna().all()


def test_what_switching_off_changes_by_hand(tmp_path: Path) -> None:
    """Three champions return 1, 2 and 3 less without plasticity, one of another cell nothing."""
    campaign = moved(tmp_path, 0.04)
    place = ("cartpole", "oja", 12, 0.25)
    rows = [(*place, seed, 10.0, 9.0 - seed) for seed in range(3)]
    rows += [("cartpole", "oja", 6, 0.25, 0, 10.0, math.nan)]
    columns = ["task", "method", "population", "learning_rate", "seed", "plastic", "fixed"]
    table = learning(campaign, pd.DataFrame(rows, columns=columns))
    assert len(table) == 3 * 2 * 2
    found = table.set_index(columns[:4]).loc[place]
    interval = stats.ttest_1samp([-1, -2, -3], 0).confidence_interval()
    assert found[["champions", "switching_off"]].tolist() == [3, -2]
    assert found[["low", "high"]].tolist() == pytest.approx([*interval])
    assert table["switching_off"].notna().sum() == 1
    near, away = describe_learning(table.assign(high=-0.1))
    assert near.startswith("Of 0 cells near control")
    assert "in 1 (lower in 1)" in away


def test_without_champions_played_again_the_movement_is_shown(tmp_path: Path) -> None:
    played = read_switched_off(str(tmp_path / "none.csv"))
    table = learning(moved(tmp_path, 0.04), played)
    assert table["switching_off"].isna().all()
    assert table["movement_over_run"].notna().all()


def test_shipped_records_a_second_time() -> None:
    """Plain pandas on the files of `demo` themselves."""
    campaign = Campaign(select("demo"), ROOT / RESULTS)
    table = movements(campaign).set_index(["task", "method", "population", "learning_rate"])
    for cell in cells(campaign.configuration):
        if cell.learning_rate is None:
            continue
        files = (ROOT / RESULTS / DEFAULT_READING / "demo" / cell.folder).glob("*.parquet")
        rows = pd.concat(map(pd.read_parquet, files))
        paths = rows.pivot(index="seed", columns="generation", values="weight_change_mean")
        found = table.loc[(cell.task, cell.method, cell.population, cell.learning_rate)]
        assert found["movement_over_run"] == pytest.approx(paths.sum(axis=1).mean())
        assert found["near_control"] == (paths.sum(axis=1).mean() < NEAR_CONTROL)
