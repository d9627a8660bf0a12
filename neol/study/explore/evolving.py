"""Small runs that are drawn while they evolve."""

import contextlib
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from neol.pictures.labels import drawn, method_label, task_label
from neol.pictures.style import GREY, WIDTH, drawing, styles
from neol.rollout import make_engine
from neol.rollout.environment import network_size
from neol.run.evolution import Evolution, Generation
from neol.run.record import HeldOut
from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec

PICTURE_SECONDS = 0.3
"""Shortest time between two pictures."""
LONGEST_SECONDS = 60.0
"""Time after which a run stops with its current generation."""
HELD_OUT_EPISODES = 20


def specification(
    *,
    task: str,
    method: str,
    learning_rate: float,
    reward_scale: float,
    population: int,
    generations: int,
    seed: int,
) -> RunSpec:
    """Return a run with the paper's constants except for these; NEAT ignores the learning rate.

    Raises UserError for values that are not allowed.
    """
    configuration = load_configuration(
        "paper",
        [
            f"plasticity.reward_scale={reward_scale}",
            f"evaluation.held_out_episodes={HELD_OUT_EPISODES}",
        ],
    )
    learns = {name for name, each in configuration.methods.items() if each.learns}
    return configuration.run_spec(
        task=task,
        method=method,
        population=population,
        learning_rate=learning_rate if method in learns else None,
        generations=generations,
        seed=seed,
    )


@dataclass(slots=True)
class Evolutions:
    """Evolve and draw a population at each call; earlier runs stay in grey."""

    earlier: list[tuple[str, str, Sequence[Generation]]] = field(default_factory=list)
    """Task, label and history of each run, the oldest first."""

    def __call__(self, **settings: Any) -> Iterator[Figure]:
        """Yield pictures of the run; the last one includes the champion's held-out episodes.

        Settings and errors are those of `specification`. A run that takes too long is stopped, and
        the picture says so.
        """
        spec = specification(**settings)
        label = f"{method_label(spec.method)} P={spec.population} seed {spec.seed}"
        if spec.plasticity.learns:
            label += f" η={spec.plasticity.learning_rate:g} β={spec.plasticity.reward_scale:g}"
        begun, latest = time.monotonic(), -float("inf")
        evolution = Evolution.begin(spec, *network_size(spec.task))
        with contextlib.closing(make_engine(spec.task)) as engine:
            for _ in evolution.run(engine):
                now = time.monotonic()
                if now - begun >= LONGEST_SECONDS:
                    break
                if now - latest >= PICTURE_SECONDS:
                    yield self._draw(spec, label, evolution.state.history)
                    latest = time.monotonic()
            held_out = HeldOut.of(evolution.held_out_returns(engine))
        mean = "failed" if held_out.mean is None else drawn(f"{held_out.mean:.1f}")
        remark = f", champion in {len(held_out.returns)} fresh episodes: {mean}"
        if len(evolution.state.history) < spec.generations:
            remark += f"\nstopped after {LONGEST_SECONDS:g} s"
        yield self._draw(spec, label, evolution.state.history, remark)
        self.earlier.append((spec.task.name, label, evolution.state.history))

    def _draw(
        self, spec: RunSpec, label: str, history: Sequence[Generation], remark: str = ""
    ) -> Figure:
        with drawing():
            figure = Figure(figsize=(WIDTH, 2.8))
            axis = figure.subplots()
            self._draw_earlier(axis, spec.task.name)
            _draw_run(axis, label, history, styles([spec.method])[spec.method].colour)
            axis.set_xlim(1, spec.generations)
            axis.xaxis.set_major_locator(MaxNLocator(6, integer=True))
            axis.set_title(f"{task_label(spec.task.name)}{remark}")
            axis.set_xlabel("Generation")
            axis.set_ylabel("Best fitness (return)")
            figure.legend(loc="outside right upper")
        return figure

    def _draw_earlier(self, axis: Axes, task: str) -> None:
        for name, label, history in self.earlier:
            if name == task:
                best = [row.best_fitness for row in history]
                x = [row.generation for row in history]
                axis.plot(x, best, color=GREY, alpha=0.5, linewidth=0.8, label=label)


def _draw_run(axis: Axes, label: str, history: Sequence[Generation], colour: str) -> None:
    x = [row.generation for row in history]
    axis.plot(x, [row.best_fitness for row in history], color=colour, label=label)
    mean = [row.mean_fitness for row in history]
    axis.plot(x, mean, color=colour, linestyle=":", label="its population's mean")
