"""The configuration of a budget, which makes the specifications of its runs.

`config/base.yaml` holds every constant with its source. A reading and a budget's file overlay it,
and `key=value` overrides come last. `python -m neol.spec.configuration` writes the JSON schemas
by which editors check these files.
"""

import contextlib
import json
import warnings
from collections.abc import Sequence
from functools import reduce
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from neol.base.errors import FOREIGN, UserError, described, hint, one_line
from neol.base.files import write_atomically
from neol.network.rules import MUTATED, RULES
from neol.spec.constants import (
    Budget,
    Evaluation,
    Method,
    Neat,
    NeatConstants,
    Network,
    Plasticity,
    PlasticityConstants,
    Task,
)
from neol.spec.readings import (
    DEFAULT_READING,
    Reading,
    make_label,
    read_reading,
    split_label,
)
from neol.spec.run_spec import RunSpec
from neol.spec.sources import Overlay
from neol.spec.types import MethodName, Model, Text

_PACKAGE = Path(__file__).resolve().parents[1]
# A wheel has `config/` and `paper/reference/` inside the package, a checkout beside it.
ROOT = _PACKAGE if (_PACKAGE / "config").is_dir() else _PACKAGE.parent
CONFIG = ROOT / "config"
READINGS = CONFIG / "readings"
_OF_EACH_TASK = ("generations", "seeds", "populations", "seeds_per_job", "configurations")
"""Keys of a budget that may have a value for each task."""
PAPER_BUDGET = "paper"
"""Budget whose constants are those of config/base.yaml."""


class Configuration(Model):
    """Resolved configuration of a budget under one reading."""

    reading: Text
    """Label of the reading (see neol.spec.readings); never written in a file."""
    tasks: dict[str, Task]
    network: Network
    plasticity: PlasticityConstants
    evaluation: Evaluation
    neat: NeatConstants
    methods: dict[MethodName, Method]
    budget: Budget

    def check_names(self, task: str, method: str) -> None:
        """Raise UserError unless both are known; `task` may be `gym:ID`."""
        if task not in self.tasks and not task.startswith("gym:"):
            raise UserError(f'unknown task "{task}"{hint(task, [*self.tasks, "gym:ID"])}')
        if method not in self.methods:
            raise UserError(f'unknown method "{method}"{hint(method, self.methods)}')

    def run_spec(
        self,
        *,
        task: str,
        method: str,
        population: int,
        generations: int,
        learning_rate: float | None = None,
        seed: int = 0,
    ) -> RunSpec:
        """Return the specification of one run.

        `task` may be `gym:ID`; `learning_rate` is None for a method without a rule.
        Raises UserError for values that are not allowed.
        """
        self.check_names(task, method)
        chosen = self.methods[method]
        if not chosen.learns and learning_rate is not None:
            raise UserError(
                f"learning_rate = {learning_rate}: {method} does not learn online; leave it out"
            )
        if chosen.learns and learning_rate is None:
            grid = ", ".join(f"{each:g}" for each in self.budget.learning_rates)
            raise UserError(
                f"{method} needs a learning rate (budget {self.budget.name} has {grid})"
            )
        constants = {} if task in self.tasks else _gymnasium_constants(task)
        if task not in self.tasks and "max_steps" not in constants:
            raise UserError(
                f"{task}: Gymnasium sets no step limit for it; give one (--max-steps 1000)"
            )
        try:
            return RunSpec(
                task=self.tasks.get(task) or Task(name=task, **constants),
                method=method,
                population=population,
                generations=generations,
                seed=seed,
                network=self.network,
                plasticity=Plasticity(
                    **self.plasticity.model_dump(),
                    rule=chosen.rule,
                    learning_rate=learning_rate or 0.0,
                ),
                evaluation=self.evaluation,
                neat=Neat(**self.neat.model_dump(), weight_mutation=chosen.weight_mutation),
            )
        except ValidationError as error:
            raise UserError(one_line(error, RunSpec)) from None


def budgets() -> list[str]:
    """Return the names of the budgets in `config/`."""
    return sorted(path.stem for path in CONFIG.glob("*.yaml") if path.stem != "base")


Option = tuple[str, tuple[str, ...], str]
"""Option of the command line, the path of keys that it sets, and its value."""


def load_configuration(
    budget: str = PAPER_BUDGET,
    overrides: Sequence[str] = (),
    options: Sequence[Option] = (),
    reading: str = DEFAULT_READING,
) -> Configuration:
    """Load config/base.yaml, overlaid by a reading, a budget's file, overrides and options in turn.

    `reading` is a label ("first+neat.elitism=3"); an override looks like "neat.elitism=3".
    Raises UserError: one line with file, key, value and what is allowed.
    """
    budget_file = _file_of(budget)
    overlay = Overlay()
    overlay.add_file(CONFIG / "base.yaml")
    _add_methods(overlay)
    reading_name, changes = split_label(reading)
    constants = read_reading(READINGS, reading_name).constants
    overlay.add((), constants, f"{READINGS.name}/{reading_name}.yaml")
    overlay.add_file(budget_file)
    for change in changes:
        overlay.add_override(change, "--reading")
    for override in overrides:
        overlay.add_override(override)
    for option, loc, value in options:
        overlay.add_option(option, loc, value)
    if "reading" in overlay.values:
        raise UserError(f"{overlay.place(('reading',))}: unknown key; --reading sets it")
    overlay.add(("reading",), reading, "--reading")
    _name(overlay, ("budget",), budget_file.stem)
    for task in overlay.values["tasks"] if isinstance(overlay.values["tasks"], dict) else ():
        _name(overlay, ("tasks", task), task)
    configuration = overlay.parse(Configuration)
    for method in configuration.budget.methods:
        if method not in configuration.methods:
            source = overlay.source(("budget", "methods"))
            raise UserError(
                f'{source}: budget.methods: no constants for "{method}" in the section methods'
            )
    for task in configuration.budget.tasks:
        if task not in configuration.tasks:
            source = overlay.source(("budget", "tasks"))
            raise UserError(
                f'{source}: budget.tasks: unknown task "{task}"{hint(task, configuration.tasks)}'
            )
    _check_values_of_tasks(configuration, overlay)
    label = _label(configuration, reading_name, changes)
    return configuration.model_copy(update={"reading": label})


def _check_values_of_tasks(configuration: Configuration, overlay: Overlay) -> None:
    """Raise UserError unless values for each task are for known tasks and for all of the budget's.

    `records_of` may leave tasks out, but names budgets.
    """
    budget = configuration.budget
    for name in (*_OF_EACH_TASK, "records_of"):
        values = getattr(budget, name)
        if not isinstance(values, dict):
            continue
        where = f"{overlay.source(('budget', name))}: budget.{name}"
        for task in values:
            if task not in configuration.tasks:
                raise UserError(f'{where}: unknown task "{task}"{hint(task, configuration.tasks)}')
        for task in budget.tasks:
            if name in _OF_EACH_TASK and task not in values:
                raise UserError(f"{where}: no value for {task}, only for {', '.join(values)}")
    for keeper in budget.records_of.values():
        if keeper not in budgets():
            source = overlay.source(("budget", "records_of"))
            unknown = f'unknown budget "{keeper}"{hint(keeper, budgets())}'
            raise UserError(f"{source}: budget.records_of: {unknown}")


def _file_of(budget: str) -> Path:
    """Return the file of a budget of `config/`, or the .yaml file that the budget is a path of."""
    if str(budget).endswith(".yaml"):
        return Path(budget)
    if budget not in budgets():
        raise UserError(f'unknown budget "{budget}"{hint(budget, [*budgets(), "PATH.yaml"])}')
    return CONFIG / f"{budget}.yaml"


def _label(configuration: Configuration, reading: str, changes: Sequence[str]) -> str:
    """Return the label of a reading with changes, each with its value in the configuration."""
    content = configuration.model_dump(mode="json")
    keys = [change.partition("=")[0].strip() for change in changes]
    values = {key: reduce(lambda part, name: part[name], key.split("."), content) for key in keys}
    return make_label(reading, values)


def configuration_schema() -> dict[str, Any]:
    """Return the JSON schema of a configuration file, which may hold any part of the constants."""
    whole = Configuration.model_json_schema()
    for part in (whole, *whole["$defs"].values()):
        part.pop("required", None)
    for named in ("Budget", "Task"):
        del whole["$defs"][named]["properties"]["name"]
    del whole["properties"]["reading"]
    return whole


def reading_schema() -> dict[str, Any]:
    """Return the JSON schema of a reading's file."""
    of_reading, constants = Reading.model_json_schema(), configuration_schema()
    sections = {name: part for name, part in constants["properties"].items() if name != "budget"}
    of_reading["properties"]["constants"] |= {
        "properties": sections,
        "additionalProperties": False,
    }
    return of_reading | {"$defs": constants["$defs"]}


def _add_methods(overlay: Overlay) -> None:
    """Add each rule's methods, without and with weight mutation, that the files do not name."""
    methods = overlay.values.get("methods")
    for rule in RULES:
        for method, mutation in ((rule, "off"), (rule + MUTATED, "config")):
            if isinstance(methods, dict) and method not in methods:
                constants = {"rule": rule, "weight_mutation": mutation}
                overlay.add(("methods", method), constants, "neol/network/rules.py")


def _name(overlay: Overlay, loc: tuple[str, ...], name: str) -> None:
    """Set the name of a task or budget, and the constants of a `gym:` task from Gymnasium."""
    content = overlay.values
    for key in loc:
        content = content.get(key, {}) if isinstance(content, dict) else {}
    if not isinstance(content, dict):
        return  # validation reports the error
    if "name" in content:
        source = overlay.source((*loc, "name"))
        raise UserError(f"{source}: {'.'.join(loc)}.name: unknown key; the name is {name} already")
    content["name"] = name
    if name.startswith("gym:"):
        for key, value in _gymnasium_constants(name).items():
            content.setdefault(key, value)


def _gymnasium_constants(task: str) -> dict[str, Any]:
    """Return the constants of the task `gym:ID` from Gymnasium's registry."""
    import gymnasium

    environment = task.removeprefix("gym:")
    if ":" in environment:
        raise UserError(
            f'task "{task}": no module is imported; register the environment and name it'
        )
    try:
        registered = gymnasium.spec(environment)
        if registered.max_episode_steps is None:  # also if it was removed: making it says so
            with warnings.catch_warnings(action="ignore"):
                made = gymnasium.make(environment, disable_env_checker=True)
                with contextlib.suppress(*FOREIGN):
                    made.close()
    except gymnasium.error.Error as error:
        raise UserError(f'task "{task}": {" ".join(str(error).split())}') from None
    except FOREIGN as error:
        raise UserError(f'task "{task}": cannot be made: {described(error)}') from error
    constants = {"environment": environment, "fresh_world": True}
    if registered.max_episode_steps is not None:
        constants["max_steps"] = registered.max_episode_steps
    return constants


if __name__ == "__main__":
    for folder, content in ((CONFIG, configuration_schema()), (READINGS, reading_schema())):
        write_atomically(folder / "schema.json", (json.dumps(content, indent=2) + "\n").encode())
