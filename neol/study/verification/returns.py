"""Bounds of an episode's return in the paper's environments, for any policy."""

from dataclasses import dataclass

from neol.spec.constants import Task


@dataclass(frozen=True, slots=True)
class Returns:
    """Bounds of an episode's return."""

    lowest: float
    highest: float
    each_step: float | None = None
    """Reward of every step, if it is constant."""


def returns_of(task: Task) -> Returns | None:
    """Return the bounds in a task; None for an environment that is not the paper's.

    They follow from each environment's source, or are far beyond what its bodies can reach.
    """
    steps = task.max_steps
    match task.environment:
        case "CartPole-v1":  # 1 for each step, the last one too
            return Returns(1.0, float(steps), each_step=1.0)
        case "LunarLander-v3":
            # 100 for the landing, at most 20 for its legs, and what the start is worse than the
            # pad: at most 142 for its distance, 110 for its speed. It can fall from any height.
            return Returns(float("-inf"), 400.0)
        case "Hopper-v4":  # a step pays 1 and the speed in m/s, which is never near 10
            return Returns(-10.0 * steps, 10.0 * steps)
        case "BipedalWalker-v3" | "BipedalWalkerHardcore-v3":
            # 130/30 for each of the at most 85 units to the end of its ground, or -100 for a fall;
            # its motors take at most 0.112 a step.
            return Returns(-200.0 - 0.112 * steps, 400.0)
    return None
