"""Films show the true episode, without a display."""

import ctypes.util
import io
import os
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import gymnasium
import numpy as np
import pytest
from PIL import Image

from neol.base.errors import UserError
from neol.pictures import film as films
from neol.pictures.film import LAST_FRAME_MS, film, need_display
from tests.champions.conftest import MakePlayer


def frames_of(gif: bytes) -> Iterator[tuple[np.ndarray, int]]:
    image = Image.open(io.BytesIO(gif))
    for number in range(image.n_frames):
        image.seek(number)
        yield np.asarray(image.convert("RGB")), image.info["duration"]


@pytest.mark.slow
@pytest.mark.parametrize("task", ["cartpole", "lunar_lander", "bipedal_walker"])
def test_a_film_shows_the_recorded_episode(task: str, player_of: MakePlayer) -> None:
    player = player_of(task)
    filmed = film(player, player.held_out_seeds[1])
    assert filmed.trace.episode_return == player.recorded_returns[1]
    assert filmed.frames == (len(filmed.trace) + 1) // 2 + 1, "every other step and the end"
    pictures, milliseconds = zip(*frames_of(filmed.gif), strict=True)
    assert pictures[0].shape == (200, 300, 3)
    assert all((one != other).any() for one, other in pairwise(pictures))
    # Two steps of a 50th of a second; what does not move is one picture that stays for longer.
    assert sum(milliseconds) == 40 * (filmed.frames - 1) + LAST_FRAME_MS
    assert all(each % 40 == 0 for each in milliseconds[:-1])


@pytest.mark.slow
def test_mujoco_is_drawn_without_a_display(player_of: MakePlayer) -> None:
    if not (ctypes.util.find_library("EGL") or ctypes.util.find_library("OSMesa")):
        pytest.skip("neither EGL nor OSMesa is here")
    player = player_of("hopper")
    filmed = film(player, player.held_out_seeds[0])
    assert filmed.trace.episode_return == player.recorded_returns[0]
    pictures, milliseconds = zip(*frames_of(filmed.gif), strict=True)
    assert pictures[0].shape == (240, 240, 3)
    assert pictures[0].std() > 10, "not all of one colour"
    assert sum(milliseconds) == 40 * (filmed.frames - 1) + LAST_FRAME_MS, "a fifth of 125 a second"


class Undrawn(gymnasium.Env[np.ndarray, int]):
    """An environment that cannot be drawn."""

    observation_space = gymnasium.spaces.Box(-1, 1, (4,))
    action_space = gymnasium.spaces.Discrete(2)
    metadata = {"render_modes": ["rgb_array"]}  # noqa: RUF012

    def __init__(self, render_mode: str | None = None) -> None:
        self.render_mode = render_mode

    def reset(self, *, seed=None, options=None):  # type: ignore[no-untyped-def]
        return np.zeros(4, dtype=np.float32), {}

    def step(self, action):  # type: ignore[no-untyped-def]
        return np.zeros(4, dtype=np.float32), 1.0, True, False, {}

    def render(self):  # type: ignore[no-untyped-def]
        raise OSError("no\nlibrary")


class Blind(Undrawn):
    """The environment does not support drawing."""

    metadata = {}  # noqa: RUF012

    def __init__(self) -> None:
        pass


@pytest.mark.parametrize(
    ("environment", "reason"), [(Undrawn, "no library"), (Blind, ".*'render_mode'.*")]
)
def test_what_cannot_be_drawn_is_said_in_one_line(
    environment: type[Undrawn], reason: str, player_of: MakePlayer, recwarn: pytest.WarningsRecorder
) -> None:
    gymnasium.register("Undrawn-v0", environment)
    player = player_of("cartpole")
    task = player.spec.task.model_copy(update={"environment": "Undrawn-v0"})
    undrawn = replace(player, spec=player.spec.model_copy(update={"task": task}))
    with pytest.raises(UserError, match=rf"Undrawn-v0 cannot be drawn here \({reason}\); choose"):
        film(undrawn, 0)
    gymnasium.registry.pop("Undrawn-v0")
    assert not recwarn.list


def test_a_window_needs_a_display(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(films.sys, "platform", "linux")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", ":0")
    need_display()
    monkeypatch.delenv("DISPLAY")
    with pytest.raises(UserError, match="--gif films without one"):
        need_display()


def test_only_without_a_display_is_drawing_kept_off_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise a window that is requested beside a film would not show."""
    monkeypatch.setattr(films.sys, "platform", "linux")
    monkeypatch.delenv("SDL_VIDEODRIVER", raising=False)
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    monkeypatch.setenv("DISPLAY", ":0")
    films._choose_backends()
    assert "SDL_VIDEODRIVER" not in os.environ
    monkeypatch.delenv("DISPLAY")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    films._choose_backends()
    assert os.environ.pop("SDL_VIDEODRIVER") == "dummy"
    assert os.environ["MUJOCO_GL"] == "osmesa", "the user's choice stays"
