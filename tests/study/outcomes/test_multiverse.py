"""The multiverse's answers, from made-up records: signs, intervals and shares."""

from pathlib import Path

import pandas as pd
import pytest

from neol.study.campaign.multiverse import complete, universes
from neol.study.outcomes.multiverse import answers, summary
from tests.helpers.universes import write_universe

TASK = "cartpole"
DEFAULT, SMALL_BETA = universes()[:2]
"""They differ in beta alone, so they share the runs of NEAT and NEAT (w/o)."""
ENDS = {"neat": 100.0, "neat_wo": 110.0, "hebb": 120.0, "oja": 100.0, "bcm": 90.0}


@pytest.fixture
def results(tmp_path: Path) -> Path:
    """Hebb leads with beta 1 and trails with 0.1; the other rules are the same with both."""
    write_universe(tmp_path, DEFAULT, TASK, ENDS)
    write_universe(tmp_path, SMALL_BETA, TASK, ENDS | {"hebb": 80.0})
    return tmp_path


def test_a_reading_counts_once_all_its_runs_are_there(results: Path) -> None:
    assert complete(TASK, results) == [DEFAULT, SMALL_BETA]
    assert complete("lunar_lander", results) == []
    next(iter(results.glob("worked_example/multiverse/cartpole/neat_wo/*/*.parquet"))).unlink()
    assert complete(TASK, results) == []


def test_answers_are_differences_of_means_with_intervals(results: Path) -> None:
    table, readings, _ = answers(results)
    assert readings == {"lunar_lander": 0, TASK: 2}
    assert len(table) == 2 * 3 * 2 * 3
    final = table[(table["metric"] == "final_best") & (table["against"] == "neat_wo")]
    found = {(row.method, row.beta): row.difference for row in final.itertuples()}
    assert found == {
        ("hebb", "1"): 10.0,
        ("oja", "1"): -10.0,
        ("bcm", "1"): -20.0,
        ("hebb", "0.1"): -30.0,
        ("oja", "0.1"): -10.0,
        ("bcm", "0.1"): -20.0,
    }
    assert (table["low"] < table["difference"]).all()
    assert (table["difference"] < table["high"]).all()


def of(table: pd.DataFrame, method: str, against: str) -> pd.Series:  # type: ignore[type-arg]
    """The summary of a question in final fitness."""
    rows = summary(table)
    chosen = (rows["method"] == method) & (rows["against"] == against)
    (place,) = rows.index[chosen & (rows["metric"] == "final_best")]
    return rows.loc[place]


def test_shares_of_readings(results: Path) -> None:
    table = answers(results).table
    hebb = of(table, "hebb", "neat_wo")
    assert (hebb["above"], hebb["clearly_above"], hebb["clearly_below"]) == (0.5, 0.5, 0.5)
    assert (hebb["least"], hebb["median"], hebb["greatest"]) == (-30.0, -10.0, 10.0)
    equal = of(table, "oja", "neat")
    assert (equal["above"], equal["clearly_above"], equal["clearly_below"]) == (0.0, 0.0, 0.0)
