"""Pictures of networks and of learning."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from neol.base.errors import UserError
from neol.champions.layout import graph
from neol.pictures.network import (
    _name_ends,
    draw_network,
    network_figure,
    plasticity_figure,
    title,
)
from neol.pictures.style import write_picture
from neol.spec.observations import NAMES
from tests.champions.conftest import MakePlayer


def lines_of(axes: Axes) -> tuple[LineCollection, LineCollection]:
    enabled, disabled = (each for each in axes.collections if isinstance(each, LineCollection))
    return enabled, disabled


def texts_of(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def test_lines_are_the_weights(player_of: MakePlayer) -> None:
    player = player_of("lunar_lander")
    axes = Figure().subplots()
    assert draw_network(axes, player) is lines_of(axes)[0]
    enabled, disabled = lines_of(axes)
    weights = player.network.weight
    assert (enabled.get_array() == weights).all()
    assert enabled.norm(0.0) == 0.5, "no weight is neither cool nor warm"
    assert enabled.norm(np.abs(weights).max()) == 1.0
    order = np.argsort(np.abs(weights))
    assert (np.diff(np.array(enabled.get_linewidths())[order]) >= 0).all()
    assert len(disabled.get_segments()) == len(graph(player).disabled) > 0
    inputs, outputs = NAMES["LunarLander-v3"]
    assert {*inputs, *outputs} <= set(texts_of(axes))


def test_a_title_says_what_it_is(player_of: MakePlayer) -> None:
    player = player_of("lunar_lander")
    mean = f"{np.mean(player.recorded_returns):.1f}".replace("-", "−")
    assert title(player).startswith("Lunar Lander, BCM, seed 3: fitness ")
    assert title(player).endswith(f"held-out mean {mean}")


@pytest.mark.parametrize(("method", "plots"), [("bcm", 3), ("oja", 2)])
def test_learning_is_drawn_as_it_was(method: str, plots: int, player_of: MakePlayer) -> None:
    player = player_of("cartpole", method)
    trace = player.play(player.held_out_seeds[0])
    figure = plasticity_figure(player, trace)
    above, below = figure.subfigs
    *panels, _bar = above.axes
    changes = trace.weights - trace.weights[0]
    for axes, step in zip(panels, (0, len(trace) // 2, len(trace)), strict=True):
        enabled, _ = lines_of(axes)
        assert (enabled.get_array() == changes[step]).all()
        largest = np.abs(trace.weights).max()
        assert enabled.norm(largest) == 1.0, "one scale for all three, that of the weights"
        assert f"(step {step})" in axes.get_title()
    largest_change = f"{np.abs(changes).max():.2g}"
    assert f"the largest change of a weight is {largest_change}," in figure.get_suptitle()
    assert len(below.axes) == plots, "thresholds only where the rule uses them"
    weight, reward = below.axes[:2]
    drawn = {tuple(line.get_ydata()) for line in weight.lines}
    assert drawn == {tuple(change) for change in changes.T}
    assert (reward.lines[0].get_ydata() == trace.rewards).all()
    assert weight.get_xlim() == reward.get_xlim(), "aligned in time"


@pytest.mark.parametrize("ends", [[0.0] * 4, [1.0] * 4, [0.5, 0.52, 1.0, 0.98]])
def test_names_of_lines_stay_apart_and_inside(ends: list[float]) -> None:
    figure = Figure(figsize=(7, 1.25), dpi=100)
    axes = figure.subplots()
    axes.set_ylim(0, 1)
    _name_ends(axes, 1.0, [(y, f"name {number}") for number, y in enumerate(ends)])
    figure.draw_without_rendering()
    heights = sorted(text.xyann[1] for text in axes.texts)
    assert all(above - below > 0.1 for below, above in pairwise(heights))
    assert heights[0] >= -1e-9
    assert heights[-1] <= 1 + 1e-9
    assert [text.get_text() for text in sorted(axes.texts, key=lambda text: text.xyann[1])] == [
        f"name {number}" for number in np.argsort(ends, kind="stable")
    ]


def test_a_champion_that_does_not_learn_is_refused(player_of: MakePlayer) -> None:
    player = player_of("cartpole", "neat")
    with pytest.raises(UserError, match="NEAT does not learn within an episode"):
        plasticity_figure(player, player.play(player.held_out_seeds[0]))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["png", "pdf", "svg"])
def test_the_same_champion_is_the_same_file(
    kind: str, player_of: MakePlayer, tmp_path: Path
) -> None:
    for name in "ab":
        write_picture(network_figure(player_of("cartpole")), tmp_path / f"{name}.{kind}")
    assert (tmp_path / f"a.{kind}").read_bytes() == (tmp_path / f"b.{kind}").read_bytes()
