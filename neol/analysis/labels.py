"""Tasks and methods as the paper prints them."""

METHODS = {"bcm": "BCM", "hebb": "Hebb", "oja": "Oja", "neat": "NEAT", "neat_wo": "NEAT (w/o)"}
TASKS = {
    "cartpole": "CartPole",
    "lunar_lander": "Lunar Lander",
    "hopper": "Hopper",
    "bipedal_walker": "Bipedal Walker",
}
HEATMAPS = {
    **{4 + position: (task, "final_best") for position, task in enumerate(TASKS)},
    **{8 + position: (task, "score") for position, task in enumerate(TASKS)},
}
"""The paper's Figures 4 to 11: task and outcome of each."""


def task_label(task: str) -> str:
    """A task's name; of one that the paper does not have, its own."""
    return TASKS.get(task, task.replace("_", " ").title())
