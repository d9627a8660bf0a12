"""Films of episodes: Gymnasium's own frames as an animated GIF."""

import contextlib
import ctypes.util
import importlib
import io
import itertools
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from PIL import Image

from neol.base.errors import UserError
from neol.champions.player import Player, Trace
from neol.rollout.environment import uses_mujoco
from neol.rollout.reference import ReferenceEngine, Step
from neol.spec.constants import Task

Drawn = TypeVar("Drawn")

FRAMES_PER_SECOND = 25
"""Largest frame rate; a film runs at its environment's speed."""
LAST_FRAME_MS = 1500
COLOURS = 64
SHRINK = 2
"""Scale of a film, relative to the 400 to 600 pixels of Gymnasium's frames."""


@dataclass(frozen=True, slots=True)
class Film:
    """A filmed episode."""

    gif: bytes
    """Animated GIF that repeats for ever."""
    frames: int
    trace: Trace
    """The filmed episode, step by step."""


def film(player: Player, seed: int, *, plastic_steps: int | None = None) -> Film:
    """Film the episode of a seed (see `Player.play`). Needs no display.

    Raises UserError where the environment cannot be drawn.
    """
    _choose_backends()
    task = player.spec.task
    pictures: list[Image.Image] = []
    steps = itertools.count()
    with contextlib.closing(_drawn(task, lambda: _camera(task))) as engine:
        stride = max(1, round(engine.steps_per_second / FRAMES_PER_SECOND))
        milliseconds = round(1000 * stride / engine.steps_per_second)

        def shoot() -> None:
            picture = _drawn(task, lambda: Image.fromarray(engine.render()).reduce(SHRINK))
            pictures.append(picture)

        def see(_step: Step) -> None:
            if next(steps) % stride == 0:
                shoot()

        trace = player.play(seed, plastic_steps=plastic_steps, engine=engine, observe=see)
        shoot()
    return Film(_gif(pictures, milliseconds), len(pictures), trace)


def need_display() -> None:
    """Raise UserError if no window can be opened; MuJoCo would abort the process instead."""
    if not _has_display():
        raise UserError("no display to open a window on; --gif films without one")


def _has_display() -> bool:
    return sys.platform != "linux" or bool({"DISPLAY", "WAYLAND_DISPLAY"} & os.environ.keys())


def _choose_backends() -> None:
    """Make SDL and MuJoCo draw without a display, unless the user has chosen a backend."""
    if not _has_display():
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    if sys.platform == "linux":
        egl = ctypes.util.find_library("EGL") is not None
        os.environ.setdefault("MUJOCO_GL", "egl" if egl else "osmesa")


def _camera(task: Task) -> ReferenceEngine:
    if uses_mujoco(task) and "MUJOCO_GL" in os.environ:
        # Fails early if the library is missing; Gymnasium would print a trace as well.
        importlib.import_module(f"mujoco.{os.environ['MUJOCO_GL']}")
    return ReferenceEngine(task, "rgb_array")


def _drawn(task: Task, draw: Callable[[], Drawn]) -> Drawn:
    """Return what a function draws. Raises UserError with the reason why it cannot."""
    try:
        return draw()
    except Exception as error:  # a drawing library may raise anything
        reason = " ".join(str(error).split())[:120]
        remedy = "choose a task that Gymnasium can draw"
        if uses_mujoco(task):
            remedy = (
                "MuJoCo needs EGL or OSMesa (on Debian: apt install libegl1 libgl1-mesa-dri, or "
                "libosmesa6), the one that MUJOCO_GL names"
            )
        raise UserError(f"{task.environment} cannot be drawn here ({reason}); {remedy}") from error


def _gif(pictures: Sequence[Image.Image], milliseconds: int) -> bytes:
    """Return an animated GIF with one palette: small files, no flickering colours."""
    some = pictures[:: max(1, len(pictures) // 8)]
    palette = Image.fromarray(np.concatenate([np.asarray(each) for each in some]))
    palette = palette.quantize(COLOURS)
    first, *others = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in pictures]
    buffer = io.BytesIO()
    first.save(
        buffer,
        format="gif",
        save_all=True,
        append_images=others,
        duration=[milliseconds] * len(others) + [LAST_FRAME_MS],
        loop=0,
    )
    return buffer.getvalue()
