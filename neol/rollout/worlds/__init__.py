"""Environments in compiled code, bit for bit as Gymnasium's; each is declared here once.

Its module has a function `simulations`, which returns for a task a maker of simulations, or one
phrase on why there is none.
"""

WORLDS = {
    "CartPole-v1": "cartpole",
    "Hopper-v4": "hopper.environment",
    "LunarLander-v3": "box2d.environment",
    "BipedalWalker-v3": "box2d.environment",
    "BipedalWalkerHardcore-v3": "box2d.environment",
}
"""Module of each compiled environment, imported when a task needs it."""
