"""The plasticity rules: how much one step changes a connection's weight (paper's Section 2).

A rule is a function of four numbers that are local to a connection: the presynaptic activity x,
the postsynaptic activity y, the weight w, and theta, the sliding mean of y^2 at the postsynaptic
node. `neol.network.plasticity` multiplies it by the gate, which follows the reward, and compiles
it. The command line, the configuration and the workflow read `RULES`: a function that is added
here is available everywhere.
"""

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass

from neol.base.errors import UserError, hint

Change = Callable[[float, float, float, float], float]
"""Change of w per unit of the gate, as a function of x, y, w and theta."""

NO_RULE = "none"
BASELINES = ("neat", "neat_wo")
"""Methods without online learning."""
MUTATED = "_mutated"
"""Ending of the methods with both a rule and weight mutation, such as oja_mutated."""


@dataclass(frozen=True, slots=True)
class Rule:
    """A plasticity rule."""

    name: str
    meaning: str
    """Meaning in one line."""
    change: Change


RULES: dict[str, Rule] = {}
"""Rules by name, in the order in which they were added."""


def method_names() -> list[str]:
    """Return the names of all methods: each rule makes two, without and with weight mutation."""
    return [*BASELINES, *RULES, *(name + MUTATED for name in RULES)]


def rule(change: Change) -> Change:
    """Add a function of (x, y, w, theta) as the plasticity rule of its name; return the function.

    The first line of its docstring is the rule's meaning. Its own module may replace a rule, so
    a notebook's cell can run again. Raises UserError for other parameters and for an invalid name
    or one that is taken.
    """
    name = change.__name__
    if list(inspect.signature(change).parameters) != ["x", "y", "w", "theta"]:
        raise UserError(f"rule {name}: must be a function of (x, y, w, theta)")
    if not re.fullmatch("[a-z][a-z0-9_]*", name):
        raise UserError(f"rule {name}: its name must be lower case, like decaying_hebb")
    if name.endswith(MUTATED):
        raise UserError(
            f"rule {name}: its name must not end in {MUTATED}, which stands for weight mutation"
        )
    elsewhere = name in RULES and RULES[name].change.__module__ != change.__module__
    if elsewhere or name in (NO_RULE, *BASELINES):
        raise UserError(f"rule {name}: the name is taken, choose another")
    RULES[name] = Rule(name, (inspect.getdoc(change) or "").partition("\n")[0], change)
    return change


def find_rule(name: str) -> Rule:
    """Return the rule of a name. Raises UserError for an unknown name."""
    if name not in RULES:
        way_out = 'if a script adds it, run "python SCRIPT", not "neol" (docs/how-to/add-a-rule.md)'
        raise UserError(f'unknown rule "{name}"{hint(name, RULES)}; {way_out}')
    return RULES[name]


@rule
def hebb(x: float, y: float, w: float, theta: float) -> float:
    """Hebb's rule (Equation 1)."""
    return x * y


@rule
def oja(x: float, y: float, w: float, theta: float) -> float:
    """Oja's rule: Hebb's rule with a decay that bounds the weights (Equation 2)."""
    return y * (x - y * w)


@rule
def bcm(x: float, y: float, w: float, theta: float) -> float:
    """The BCM rule: depression below the threshold theta, potentiation above (Equation 3)."""
    return y * (y - theta) * x
