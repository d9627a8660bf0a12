"""NEOL: reward-gated online plasticity for NEAT, reproduced.

The library in six steps. A configuration holds every constant and makes the specification of a run;
the run makes a record:

>>> from pathlib import Path
>>> import neol
>>> configuration = neol.load_configuration("smoke", ["evaluation.held_out_episodes=3"])
>>> spec = configuration.run_spec(
...     task="cartpole", method="oja", population=6, learning_rate=0.25, generations=2
... )
>>> record = neol.evolve(spec, seeds=[0, 1])
>>> record.frame()[["seed", "generation", "evaluations"]]
   seed  generation  evaluations
0     0           1            6
1     0           2           12
2     1           1            6
3     1           2           12

A record is one file that carries its own digest; a folder of records reads as a table of runs:

>>> neol.write_record(Path("runs/oja.parquet"), record)
>>> neol.read_record(Path("runs/oja.parquet")).spec == spec
True
>>> neol.table_of_runs(Path("runs"))[["record", "method", "seed"]]
        record method  seed
0  oja.parquet    oja     0
1  oja.parquet    oja     1

A record's champion can replay the recorded episodes exactly, or play new ones:

>>> champion = neol.load_champion(Path("runs/oja.parquet"), seed=1)
>>> champion.evaluate(champion.held_out_seeds).tolist() == list(champion.recorded_returns)
True
>>> champion.evaluate([1, 2, 3, 4, 5]).shape
(5,)

A plasticity rule is a function (docs/how-to/add-a-rule.md), and any Gymnasium environment with
flat spaces is a task (docs/how-to/add-a-task.md):

>>> @neol.rule
... def decaying_hebb(x, y, w, theta):
...     '''Hebb's rule with weights that decay.'''
...     return x * y - 0.1 * w
>>> acrobot = neol.load_configuration().run_spec(
...     task="gym:Acrobot-v1",
...     method="decaying_hebb",
...     population=50,
...     learning_rate=0.25,
...     generations=100,
... )
>>> acrobot.task.max_steps
500

Wrong input raises a `UserError`: one line that says what is wrong and how to fix it.

>>> configuration.run_spec(task="carpole", method="neat", population=6, generations=2)
Traceback (most recent call last):
neol.base.errors.UserError: unknown task "carpole", did you mean "cartpole"? (allowed: ...)
"""

import importlib
import importlib.metadata
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from neol.base.errors import UserError
    from neol.champions.player import Player, load_champion
    from neol.network.rules import rule
    from neol.run.catalogue import table_of_runs
    from neol.run.record import Record
    from neol.run.record_file import read_record, write_record
    from neol.run.runner import evolve
    from neol.spec.configuration import Configuration, load_configuration
    from neol.spec.run_spec import RunSpec

_MODULES = {
    "neol.run.catalogue": ("table_of_runs",),
    "neol.champions.player": ("Player", "load_champion"),
    "neol.base.errors": ("UserError",),
    "neol.run.record": ("Record",),
    "neol.run.record_file": ("read_record", "write_record"),
    "neol.network.rules": ("rule",),
    "neol.run.runner": ("evolve",),
    "neol.spec.configuration": ("Configuration", "load_configuration"),
    "neol.spec.run_spec": ("RunSpec",),
}
"""The module of each public name, imported when one of its names is first used."""

__all__ = [
    "Configuration",
    "Player",
    "Record",
    "RunSpec",
    "UserError",
    "evolve",
    "load_champion",
    "load_configuration",
    "read_record",
    "rule",
    "table_of_runs",
    "write_record",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return importlib.metadata.version("neol")
    for module, names in _MODULES.items():
        if name in names:
            return getattr(importlib.import_module(module), name)
    raise AttributeError(f"module neol has no attribute {name!r}")
