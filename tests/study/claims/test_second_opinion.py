"""Every verdict once more, from records and from made-up runs, by code of its own."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from neol.spec.configuration import ROOT
from neol.study.campaign.grid import RESULTS, blocks
from neol.study.campaign.shown import DEFAULT_BUDGET, select, two_by_two
from neol.study.claims.answers import answers
from neol.study.claims.calibration import MadeUp, made_up_studies
from neol.study.claims.ledger import as_table
from neol.study.claims.questions import load_questions
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.outcomes import gather
from tests.study.claims.second_opinion import Study, opinions

RECORDS = ROOT / RESULTS
COLUMNS = ["effect", "low", "high", "p_holm", "for", "against", "open"]


class Records(Study):
    """Shipped records, read as plain Parquet."""

    def __init__(self, paths: list[Path]) -> None:
        self.histories: dict[Any, pd.DataFrame] = {}
        rows = []
        for path in sorted(paths):
            task, method, cell = path.parts[-4:-1]
            size, _, rate = cell.removeprefix("p").partition("_lr")
            frame = pq.read_table(path).to_pandas()
            key = task, method, int(size), float(rate) if rate else None
            self.histories[key] = pd.concat([self.histories.get(key, frame[:0]), frame])
        generations = {}
        for (task, method, size, rate), frame in self.histories.items():
            generations[task] = int(frame["generation"].max())
            largest = max(key[2] for key in self.histories if key[0] == task)
            samples = 1e8 * generations[task] * largest / (500 * 300)
            for seed, run in frame.sort_values("generation").groupby("seed"):
                best = run["best_fitness"].to_numpy()
                score = size / samples * best.sum()
                rows.append((task, method, size, rate or np.nan, seed, best[-1], score))
        names = ["task", "method", "population", "rate", "seed", "final_best", "score"]
        super().__init__(pd.DataFrame(rows, columns=names), generations, self.at_equal_cost)

    def at_equal_cost(self, _: str, task: str, sides: Any) -> Study:
        """Return the same runs with their mean best so far over these cells' common range."""
        cells = [cell for some, _, _ in sides for cell in some]
        ends = [
            (run["evaluations"].min(), run["evaluations"].max())
            for cell in cells
            for _, run in self.histories[cell].groupby("seed")
        ]
        first, last = max(low for low, _ in ends), min(high for _, high in ends)
        rows = []
        for _, method, size, rate in cells:
            for seed, run in self.histories[task, method, size, rate].groupby("seed"):
                best = run["best_fitness"].cummax().to_numpy()
                each = np.searchsorted(run["evaluations"], np.arange(first, last), side="right")
                mean = best[each - 1].mean()  # at every single evaluation of the range
                rows.append((task, method, size, rate or np.nan, seed, mean))
        names = ["task", "method", "population", "rate", "seed", "equal_evaluations"]
        return Study(pd.DataFrame(rows, columns=names), self.generations)


def agree(ours: pd.DataFrame, theirs: pd.DataFrame) -> None:
    whole = ours[ours["part"] == "all"].set_index("question")
    assert list(whole.index) == list(theirs.index)
    assert whole["verdict"].to_dict() == theirs["verdict"].to_dict()
    for frame in (whole, theirs):  # the second opinion solves for no larger p-values than this
        frame["p_holm"] = frame["p_holm"].clip(upper=0.2)
    for column in COLUMNS:
        np.testing.assert_allclose(
            whole[column].astype(float), theirs[column].astype(float),
            rtol=2e-3, atol=1e-6, err_msg=column,
        )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("budget", [DEFAULT_BUDGET, "demo"])
def test_shipped_records_give_the_same_verdicts(budget: str) -> None:
    configuration = select(budget)
    all_of = [configuration, *two_by_two(configuration)]
    ours = as_table(
        answers(load_questions(), gather(*(Campaign(each, RECORDS) for each in all_of)))
    )
    paths = [RECORDS / block.record for each in all_of for block in blocks(each)]
    agree(ours, opinions(Records([path for path in paths if path.exists()])))


def as_frame(made_up: MadeUp) -> Study:
    """Made-up runs as the second opinion reads them."""
    rows = [
        (cell.task, cell.method, cell.population, cell.learning_rate or np.nan, seed, *each)
        for cell in made_up.cells
        for seed, each in enumerate(
            zip(*(made_up.samples([cell], name)[0] for name in OUTCOMES), strict=True)
        )
    ]
    names = ["task", "method", "population", "rate", "seed", *OUTCOMES]
    frame = pd.DataFrame(rows, columns=names)
    study = Study(frame, dict.fromkeys(frame["task"].unique(), 500))
    study.equal = lambda *_: study
    return study


OUTCOMES = ["final_best", "score", "equal_evaluations"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truth", "seeds"), [("null", 30), ("shift", 30), ("paper", 30), ("paper", 20), ("rates", 10)]
)
def test_made_up_studies_give_the_same_verdicts(truth: str, seeds: int) -> None:
    """Made-up runs have 500 generations, where every verdict is possible."""
    made_up = replace(next(made_up_studies(truth)), available=seeds)
    ours = as_table(answers(load_questions(), made_up))
    agree(ours, opinions(as_frame(made_up)))
