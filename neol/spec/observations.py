"""Names of a task's inputs and outputs, from Gymnasium's documentation."""

from neol.spec.constants import Task

_WALKER = (
    (
        "hull angle",
        "hull angular velocity",
        "x velocity",
        "y velocity",
        *(
            f"{joint} {leg} {quantity}"
            for leg in (1, 2)
            for joint, quantity in (("hip", "angle"), ("hip", "speed"), ("knee", "angle"),
                                    ("knee", "speed"), ("leg", "contact"))
        ),
        *(f"lidar {beam}" for beam in range(1, 11)),
    ),
    ("hip 1 torque", "knee 1 torque", "hip 2 torque", "knee 2 torque"),
)  # fmt: skip

NAMES = {
    "CartPole-v1": (
        ("cart position", "cart velocity", "pole angle", "pole angular velocity"),
        ("push left", "push right"),
    ),
    "LunarLander-v3": (
        (
            "x position",
            "y position",
            "x velocity",
            "y velocity",
            "angle",
            "angular velocity",
            "left leg contact",
            "right leg contact",
        ),
        ("do nothing", "left engine", "main engine", "right engine"),
    ),
    "Hopper-v4": (
        (
            "torso height",
            "torso angle",
            "thigh angle",
            "leg angle",
            "foot angle",
            "torso x velocity",
            "torso z velocity",
            "torso angular velocity",
            "thigh angular velocity",
            "leg angular velocity",
            "foot angular velocity",
        ),
        ("thigh torque", "leg torque", "foot torque"),
    ),
    "BipedalWalker-v3": _WALKER,
    "BipedalWalkerHardcore-v3": _WALKER,
}
"""Names of inputs and of outputs, by Gymnasium id."""


def size_of(environment: str) -> tuple[int, int] | None:
    """Return the numbers of inputs and outputs of a listed environment, without making it.

    Making an environment takes seconds. None for one that is not listed.
    """
    if environment not in NAMES:
        return None
    inputs, outputs = NAMES[environment]
    return len(inputs), len(outputs)


def names(task: Task, inputs: int, outputs: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of inputs and outputs; "input 1" and so on for a task without names."""
    if task.environment in NAMES:
        return NAMES[task.environment]
    return (
        tuple(f"input {number}" for number in range(1, inputs + 1)),
        tuple(f"output {number}" for number in range(1, outputs + 1)),
    )
