"""Rollouts: networks play episodes of a task and learn in them; independent of genomes."""

import sys
from functools import partial
from typing import Literal

from neol.base.errors import NOTICE, UserError
from neol.rollout.engine import Engine, Rollouts
from neol.spec.constants import Task

EngineName = Literal["auto", "fast", "reference"]

__all__ = ["Engine", "EngineName", "Rollouts", "describe", "make_engine"]


def make_engine(task: Task, name: EngineName = "auto", workers: int = 1) -> Engine:
    """Return the engine that plays a task's episodes with a number of workers.

    `fast` is compiled and exists for the paper's tasks; `reference` runs any environment; `auto`
    takes `fast` if possible, and prints a note if the installation prevents it. All return the
    same bits. Raises UserError if `fast` is requested and unavailable, or the environment unknown.
    """
    from neol.rollout.parallel import ProcessEngine
    from neol.rollout.reference import ReferenceEngine

    if name != "reference":
        from neol.rollout.fast import fast_engine
        from neol.rollout.worlds import WORLDS

        engine = fast_engine(task, workers)
        if isinstance(engine, Engine):
            return engine
        if name == "fast":
            raise UserError(f"no fast engine for {task.environment}: {engine}; use --engine auto")
        if task.environment in WORLDS:
            notice = f"{NOTICE}the reference engine plays {task.environment}: {engine}"
            print(notice, file=sys.stderr)
    if workers == 1:
        return ReferenceEngine(task)
    ReferenceEngine(task).close()  # report an impossible task here, not in a worker
    return ProcessEngine(partial(ReferenceEngine, task), ReferenceEngine.name, workers)


def describe(task: Task, engine: str) -> str:
    """Return an engine's name and, for Box2D, the path of its physics."""
    from neol.rollout.worlds.box2d import library as box2d

    core = box2d.load() if engine == "fast" and task.environment in box2d.TASKS else ""
    return engine if isinstance(core, str) else f"{engine}; physics: {box2d.chosen_path(core)}"
