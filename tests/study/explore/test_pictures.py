"""Pictures to play with: what they show is what the records and episodes hold."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes

from neol.base.errors import UserError
from neol.run.catalogue import table_of_runs
from neol.run.runner import run_block
from neol.study.explore.panel import load_player
from neol.study.explore.pictures import (
    draw_learning_curves,
    draw_outcomes,
    effect_of_learning,
    switched_off,
)
from neol.study.outcomes.statistics import mean_interval
from tests.helpers.made_up import configuration, write_campaign
from tests.helpers.runs import run_spec
from tests.study.explore.test_runs import BEST

SETTING = ("rare_mutation/smoke", 6, 0.25)


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    results = tmp_path_factory.mktemp("pictures") / "results"
    write_campaign(results, configuration(), BEST)
    return results


@pytest.fixture(scope="module")
def runs(results: Path) -> pd.DataFrame:
    return table_of_runs(results)


def lines(axis: Axes) -> dict[str, tuple[list[float], list[float]]]:
    """x and y of each line by its label."""
    return {
        str(line.get_label()): (list(line.get_xdata()), list(line.get_ydata()))  # type: ignore[arg-type]
        for line in axis.get_lines()
    }


def test_curves_are_means_over_seeds(results: Path, runs: pd.DataFrame) -> None:
    figure = draw_learning_curves(
        results, runs, task="cartpole", setting=SETTING, column="best_fitness", against="generation"
    )
    drawn = lines(figure.axes[0])
    assert drawn["Hebb, 3 seeds"] == ([1, 2], [3.0, 2.0])  # made-up runs fall by 1 to their end
    assert drawn["NEAT, 2 seeds"] == ([1, 2], [5.5, 4.5])
    assert len(drawn) == 5
    assert figure.axes[0].get_ylabel() == "Best fitness (return)"


def test_curves_against_cost(results: Path, runs: pd.DataFrame) -> None:
    figure = draw_learning_curves(
        results, runs, task="cartpole", setting=SETTING, column="species", against="evaluations"
    )
    assert lines(figure.axes[0])["Oja, 3 seeds"][0] == [6, 12]
    assert figure.axes[0].get_ylabel() == "Species"
    assert figure.axes[0].get_xlabel() == "Evaluations (genomes)"


def test_curves_of_what_there_is_not_are_refused(results: Path, runs: pd.DataFrame) -> None:
    with pytest.raises(
        UserError, match="budget rare_mutation/smoke has no runs of hopper with P = 6"
    ):
        draw_learning_curves(
            results, runs, task="hopper", setting=SETTING, column="species", against="evaluations"
        )


def test_outcomes_show_every_run_and_the_mean(runs: pd.DataFrame) -> None:
    again = pd.concat([runs, runs.assign(budget="demo")])
    shown = {"budget": "rare_mutation/smoke", "outcome": "held_out"}
    axis = draw_outcomes(again, task="cartpole", by="learning_rate", **shown).axes[0]
    here = runs[runs["learning_rate"] == 0.25]["held_out"]
    drawn = [line.get_ydata() for line in axis.get_lines()]
    assert list(drawn[2]) == here.tolist()
    assert list(drawn[3]) == [here.mean()]
    assert [text.get_text() for text in axis.get_xticklabels()] == [
        "0.0025\n18 runs",
        "0.25\n18 runs",
    ]
    with pytest.raises(
        UserError, match="rare_mutation/smoke has no run of hopper with method and held_out"
    ):
        draw_outcomes(runs, task="hopper", by="method", **shown)


def test_plasticity_switched_off_in_mid_episode(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    run_block(run_spec("oja"), [0], path, engine="reference")
    player = load_player(path, 0)
    reward, weight, returns = switched_off(player, step=3, episodes=3).axes
    plastic, frozen = (list(line.get_ydata()) for line in weight.get_lines()[:2])
    assert plastic[:4] == frozen[:4]
    assert set(frozen[3:]) == {frozen[3]}
    assert plastic[4] != plastic[3]
    traces = [player.play(seed) for seed in player.held_out_seeds]
    stopped = [player.play(seed, plastic_steps=3) for seed in player.held_out_seeds]
    assert list(reward.get_lines()[0].get_ydata()) == np.cumsum(traces[0].rewards).tolist()
    x, y = (np.array([t.episode_return for t in each]) for each in (traces, stopped))
    dots = returns.get_lines()[1]
    assert list(dots.get_xdata()) == x.tolist()
    assert list(dots.get_ydata()) == y.tolist()
    low, high = mean_interval(y - x)
    gain = f"Stopping gains {np.mean(y - x):+.1f}\n(95%: {low:+.1f} to {high:+.1f})"
    assert returns.get_title() == gain.replace("-", "−")


class _Played(NamedTuple):
    episode_return: float


@pytest.mark.parametrize(
    ("gains", "said"),
    [
        ([10.0, 12.0, 11.0], "plasticity after step 5 raises this champion's return"),
        ([-10.0, -12.0, -11.0], "plasticity after step 5 lowers this champion's return"),
        ([-10.0, 12.0, 1.0], "do not show that plasticity after step 5 changes"),
        ([0.0, 0.0, 0.0], "do not show that plasticity after step 5 changes"),
    ],
)
def test_the_effect_of_learning_is_said_with_its_interval(gains: list[float], said: str) -> None:
    plastic: Any = [_Played(gain) for gain in gains]
    frozen: Any = [_Played(0.0) for _ in gains]
    sentence = effect_of_learning(plastic, frozen, 5)
    assert said in sentence
    assert f"mean change {sum(gains) / 3:+.1f} [" in sentence
