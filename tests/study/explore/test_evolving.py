"""Small runs, drawn while they evolve."""

from collections.abc import Generator

import numpy as np
import pytest
from matplotlib.figure import Figure

from neol.base.errors import UserError
from neol.rollout.fast import FastEngine
from neol.run.evolution import Evolution
from neol.study.explore import evolving
from neol.study.explore.evolving import Evolutions
from tests.helpers.runs import evolve

SMALL = {
    "task": "cartpole",
    "population": 4,
    "generations": 3,
    "seed": 1,
    "learning_rate": 0.25,
    "reward_scale": 0.5,
}


@pytest.fixture(autouse=True)
def _unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiling takes long on some machines."""
    monkeypatch.setattr(evolving, "LONGEST_SECONDS", float("inf"))


def labels(figure: Figure) -> list[str]:
    return [str(line.get_label()) for line in figure.axes[0].get_lines()]


def test_each_generation_is_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evolving, "PICTURE_SECONDS", 0.0)
    evolutions = Evolutions()
    pictures = list(evolutions(method="oja", **SMALL))  # type: ignore[arg-type]
    lengths = [len(picture.axes[0].get_lines()[0].get_xdata()) for picture in pictures]  # type: ignore[arg-type]
    assert lengths == [1, 2, 3, 3]
    assert labels(pictures[-1]) == ["Oja P=4 seed 1 η=0.25 β=0.5", "its population's mean"]
    title = pictures[-1].axes[0].get_title()
    assert title.startswith("CartPole, champion in 20 fresh episodes: ")
    assert "stopped" not in title


def test_what_is_drawn_is_the_run_of_that_specification() -> None:
    evolutions = Evolutions()
    *_, last = evolutions(method="oja", **SMALL)  # type: ignore[arg-type]
    drawn = last.axes[0].get_lines()[0].get_ydata()
    expected = evolve(evolving.specification(method="oja", **SMALL))  # type: ignore[arg-type]
    assert list(drawn) == [row.best_fitness for row in expected.state.history]


def test_earlier_runs_of_the_task_stay() -> None:
    evolutions = Evolutions()
    list(evolutions(method="neat", **SMALL))  # type: ignore[arg-type]
    *_, last = evolutions(method="bcm", **SMALL)  # type: ignore[arg-type]
    assert labels(last)[0] == "NEAT P=4 seed 1"
    assert labels(last)[1].startswith("BCM ")


def test_a_run_that_takes_too_long_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evolving, "LONGEST_SECONDS", 0.0)
    (only,) = Evolutions()(method="oja", **SMALL)  # type: ignore[arg-type]
    (axis,) = only.axes
    assert list(axis.get_lines()[0].get_xdata()) == [1]
    assert axis.get_title().endswith("\nstopped after 0 s")
    assert axis.get_xlim() == (1, 3)


@pytest.mark.parametrize(
    ("returns", "told"), [([10.0, np.nan, 20.0], "3 fresh episodes: 15.0"), ([np.nan], ": failed")]
)
def test_a_failed_episode_has_no_return(
    returns: list[float], told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Evolution, "held_out_returns", lambda *_: np.array(returns))
    *_, last = Evolutions()(method="oja", **SMALL)  # type: ignore[arg-type]
    assert last.axes[0].get_title().endswith(told)


def test_an_engine_is_closed_where_nobody_looks_on(monkeypatch: pytest.MonkeyPatch) -> None:
    closed: list[FastEngine] = []
    monkeypatch.setattr(FastEngine, "close", lambda engine: closed.append(engine))
    pictures = Evolutions()(method="oja", **SMALL)  # type: ignore[arg-type]
    next(pictures)
    assert isinstance(pictures, Generator)
    pictures.close()
    assert len(closed) == 1


def test_what_no_run_can_be_is_refused() -> None:
    with pytest.raises(UserError, match="population"):
        next(Evolutions()(method="bcm", **SMALL | {"population": 1}))  # type: ignore[arg-type]
