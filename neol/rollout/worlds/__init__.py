"""Environments in compiled code, each bit for bit Gymnasium's. Here every one is declared once.

A module has the function `simulations`: for a task, what makes simulations of it, or in one phrase
why nothing here does.
"""

WORLDS = {
    "CartPole-v1": "cartpole",
    "Hopper-v4": "hopper.environment",
    "LunarLander-v3": "box2d.environment",
    "BipedalWalker-v3": "box2d.environment",
    "BipedalWalkerHardcore-v3": "box2d.environment",
}
"""The module that plays each of Gymnasium's environments. It is imported when a task needs it."""
