"""What a run is: every constant typed, validated and hashable.

The types hold no values. `config/base.yaml` holds every constant with its source, a budget's file
overlays it, and `key=value` overrides come last. `python -m neol.spec` writes `config/schema.json`,
which editors check these files with.
"""

import hashlib
import json
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, LiteralString, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from neol.complaint import hint, one_line
from neol.errors import UserError
from neol.overlay import Overlay
from neol.rules import NO_RULE, RULES, WITHOUT_RULE

_PACKAGE = Path(__file__).resolve().parent
# A wheel carries `config/` and `paper/reference/` inside the package, a checkout beside it.
ROOT = _PACKAGE if (_PACKAGE / "config").is_dir() else _PACKAGE.parent
CONFIG = ROOT / "config"
DEFAULT_BUDGET = "paper"
"""Its constants are those of config/base.yaml."""


def _union(sentence: LiteralString) -> WrapValidator:
    """Say in one sentence what is allowed where pydantic would report on each member of a union."""

    def check(value: Any, validate: ValidatorFunctionWrapHandler) -> Any:
        try:
            return validate(value)
        except ValidationError:
            raise PydanticCustomError("union", sentence) from None

    return WrapValidator(check)


Item = TypeVar("Item")


def _distinct(values: tuple[Item, ...]) -> tuple[Item, ...]:
    if len(set(values)) < len(values):
        raise PydanticCustomError("distinct", "must not name a value twice")
    return values


@dataclass(frozen=True, slots=True)
class _OneOf:
    """Allows a string among names that are asked for each time: rules may be added."""

    names: Callable[[], Sequence[str]]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**handler(schema), "enum": list(self.names())}

    def _check(self, value: str) -> str:
        *most, last = map(repr, self.names())
        if value not in self.names():
            raise PydanticCustomError(
                "one_of", "must be {most} or {last}", {"most": ", ".join(most), "last": last}
            )
        return value


Probability = Annotated[float, Field(ge=0, le=1)]
PositiveInt = Annotated[int, Field(ge=1)]
NonNegativeInt = Annotated[int, Field(ge=0)]
PositiveFloat = Annotated[float, Field(gt=0)]
NonNegativeFloat = Annotated[float, Field(ge=0)]
Population = Annotated[int, Field(ge=2, le=100_000)]  # a slip of the hand would fill the memory
Text = Annotated[str, Field(min_length=1)]
Several = Annotated[
    tuple[Item, ...],
    Field(min_length=1, json_schema_extra={"uniqueItems": True}),
    AfterValidator(_distinct),
]

RuleName = Annotated[str, _OneOf(lambda: [NO_RULE, *RULES])]
MethodName = Annotated[str, _OneOf(lambda: [*WITHOUT_RULE, *RULES])]
WeightMutation = Annotated[
    Literal["off", "config"] | Probability,
    _union("must be 'off', 'config' or a probability from 0 to 1"),
]
ForEachTask = Annotated[
    PositiveInt | dict[Text, PositiveInt],
    _union("must be an integer of at least 1, or such an integer for each task"),
]


class Model(BaseModel):
    """Immutable, strict about types, without unknown keys and without infinities."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
    )


class Task(Model):
    """A Gymnasium environment and how long an episode of it may be (Section 4.1)."""

    name: Text
    """Its key under `tasks`; never written in a file."""
    environment: Annotated[str, Field(pattern="^[^:]+$")]
    """Gymnasium id, without a module: a file from elsewhere must not have one imported."""
    max_steps: PositiveInt
    """T_max: an episode's limit in environment steps."""
    fresh_world: bool
    """Make a new environment for every episode: its reset does not forget the one before."""


class Network(Model):
    """The phenotype (Section 4.1, "Algorithm Protocol")."""

    hidden_activation: Literal["tanh", "relu", "sigmoid", "identity"]
    sum_limit: PositiveFloat
    """A node's sum is clipped to +- this before its activation."""


class PlasticityConstants(Model):
    """What all rules share (Section A.3)."""

    reward_scale: PositiveFloat
    """beta."""
    threshold_rate: Annotated[float, Field(gt=0, le=1)]
    """alpha of the sliding threshold."""
    weight_limit: PositiveFloat
    """A weight is clipped to +- this after every update."""
    write_back: bool
    """Write an episode's learned weights to the genome (Lamarckian inheritance)."""


class Plasticity(PlasticityConstants):
    """The plasticity of a run."""

    rule: Text
    """A record may name one that is not known here; no engine plays with it."""
    learning_rate: NonNegativeFloat
    """eta."""

    @property
    def learns(self) -> bool:
        """Whether there is a rule at all."""
        return self.rule != NO_RULE


class Evaluation(Model):
    """How a genome gets its fitness (Algorithm 2), and the champion its held-out score."""

    episodes: Annotated[int, Field(ge=1, le=1_000)]
    """N: fitness is the mean return over N episodes."""
    held_out_episodes: Annotated[int, Field(ge=1, le=100_000)]
    """Fresh episodes that the champion is evaluated on."""
    step_limit: PositiveInt | None
    """A run ends with the generation that reaches this many environment steps; null: no limit."""


class NeatConstants(Model):
    """NEAT (Algorithms 3 and 4); rates are probabilities."""

    weight_init_sd: NonNegativeFloat
    weight_mutate_rate: Probability
    weight_mutate_power: NonNegativeFloat
    """Standard deviation of a perturbation."""
    weight_replace_rate: Probability
    weight_limit: PositiveFloat
    bias_init_sd: NonNegativeFloat
    bias_mutate_rate: Probability
    bias_mutate_power: NonNegativeFloat
    """Standard deviation of a perturbation."""
    bias_replace_rate: Probability
    bias_limit: PositiveFloat
    enabled_mutate_rate: Probability
    disable_rate: Probability
    """A gene disabled in either parent is disabled in the child."""
    add_connection_rate: Probability
    """m_l."""
    add_node_rate: Probability
    """m_n."""
    remove_connection_rate: Probability
    remove_node_rate: Probability
    crossover_rate: Probability
    """p_c."""
    survival_threshold: Annotated[float, Field(gt=0, le=1)]
    """rho: the fraction of a species that may become parents."""
    elitism: NonNegativeInt
    """E: genomes of a species copied unchanged."""
    min_species_size: PositiveInt
    disjoint_coefficient: NonNegativeFloat
    """c_1."""
    weight_coefficient: NonNegativeFloat
    """c_3."""
    compatibility_threshold: PositiveFloat
    """delta_t."""
    distance_normaliser: Literal["matching", "larger_genome"]
    """N of the distance."""
    sharing: Literal["stanley", "literal"]
    max_stagnation: PositiveInt
    """G_stag: generations without a better best fitness."""
    species_elitism: NonNegativeInt
    """Species that never die of stagnation."""


class Neat(NeatConstants):
    """The NEAT of a run."""

    weight_mutation: WeightMutation
    """WM_MODE: off, config (the rates above) or a probability in place of weight_mutate_rate."""


class Method(Model):
    """What distinguishes NEAT, NEAT (w/o) and the rules of NEOL."""

    rule: RuleName
    weight_mutation: WeightMutation
    """WM_MODE: off, config or a probability."""

    @property
    def learns(self) -> bool:
        """Whether it has a rule at all."""
        return self.rule != NO_RULE


class RunSpec(Model):
    """Everything that a run's trajectory is a function of."""

    task: Task
    method: Text
    population: Population
    """P."""
    generations: PositiveInt
    """G."""
    seed: NonNegativeInt
    network: Network
    plasticity: Plasticity
    evaluation: Evaluation
    neat: Neat

    @model_validator(mode="after")
    def _agrees(self) -> "RunSpec":
        if not self.plasticity.learns and self.plasticity.learning_rate > 0:
            raise PydanticCustomError("rate", "a learning rate needs a plasticity rule")
        if self.neat.min_species_size > self.population:
            raise PydanticCustomError(
                "species",
                "neat.min_species_size = {size}: must not exceed the population, {population}",
                {"size": self.neat.min_species_size, "population": self.population},
            )
        return self

    def digest(self) -> str:
        """SHA-256 in hex of the specification as canonical JSON."""
        return _sha256(self.model_dump(mode="json"))

    def trajectory_key(self) -> str:
        """The digest without `generations`: runs that share it are prefixes of each other."""
        return _sha256(self.model_dump(mode="json", exclude={"generations"}))


class Budget(Model):
    """How much a campaign spends."""

    name: Text
    """The name of its file; never written in it."""
    generations: ForEachTask
    """G: of any task, or for each."""
    seeds: Annotated[int, Field(ge=1, le=10_000)]
    """How many: a cell runs with seeds 0 to seeds - 1."""
    populations: Several[Population]
    learning_rates: Several[NonNegativeFloat]
    """Grid of eta for the methods with a rule."""
    tasks: Several[Text]
    methods: Several[MethodName]
    seeds_per_job: ForEachTask
    """Runs of a cell that one job of the workflow makes: of any task, or for each."""

    def generations_of(self, task: str) -> int:
        """G of a task's runs."""
        return _of_task(self.generations, task)

    def seeds_per_job_of(self, task: str) -> int:
        """How many runs one job makes of a task's cell."""
        return _of_task(self.seeds_per_job, task)


def _of_task(number: int | dict[str, int], task: str) -> int:
    return number if isinstance(number, int) else number[task]


class Configuration(Model):
    """A budget's resolved configuration."""

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
        """The specification of one run.

        `task` may be `gym:ID`; `learning_rate` is None for a method without a rule.

        Raises UserError for whatever is not allowed.
        """
        self.check_names(task, method)
        chosen = self.methods[method]
        if not chosen.learns and learning_rate is not None:
            raise UserError(
                f"learning_rate = {learning_rate}: {method} does not learn online, leave it out"
            )
        if chosen.learns and learning_rate is None:
            grid = ", ".join(f"{rate:g}" for rate in self.budget.learning_rates)
            raise UserError(
                f"{method} needs a learning rate (budget {self.budget.name} has {grid})"
            )
        constants = {} if task in self.tasks else _gymnasium_constants(task)
        if task not in self.tasks and "max_steps" not in constants:
            raise UserError(
                f"{task}: Gymnasium sets it no limit of steps; give one (--max-steps 1000)"
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
    """The names of the budgets that `config/` has."""
    return sorted(path.stem for path in CONFIG.glob("*.yaml") if path.stem != "base")


Option = tuple[str, tuple[str, ...], str]
"""An option of the command line, the path of keys that it stands for, and its value."""


def load_configuration(
    budget: str = DEFAULT_BUDGET,
    overrides: Sequence[str] = (),
    options: Sequence[Option] = (),
) -> Configuration:
    """config/base.yaml, overlaid by the budget's file, by overrides ("neat.elitism=3"), by options.

    Raises UserError, in one line with file, key, value and what is allowed.
    """
    if budget not in budgets():
        raise UserError(f'unknown budget "{budget}"{hint(budget, budgets())}')
    overlay = Overlay()
    overlay.add_file(CONFIG / "base.yaml")
    _add_methods(overlay)
    overlay.add_file(CONFIG / f"{budget}.yaml")
    for override in overrides:
        overlay.add_override(override)
    for option, loc, value in options:
        overlay.add_option(option, loc, value)
    _name(overlay, ("budget",), budget)
    for task in overlay.values["tasks"] if isinstance(overlay.values["tasks"], dict) else ():
        _name(overlay, ("tasks", task), task)
    try:
        configuration = Configuration.model_validate_json(json.dumps(overlay.values))
    except ValidationError as error:
        raise UserError(one_line(error, Configuration, overlay.place)) from None
    for task in configuration.budget.tasks:
        if task not in configuration.tasks:
            source = overlay.source(("budget", "tasks"))
            raise UserError(
                f'{source}: budget.tasks: unknown task "{task}"{hint(task, configuration.tasks)}'
            )
        for name in ("generations", "seeds_per_job"):
            numbers = getattr(configuration.budget, name)
            if isinstance(numbers, dict) and task not in numbers:
                source = overlay.source(("budget", name))
                raise UserError(f"{source}: budget.{name}: no number for {task}")
    return configuration


def schema() -> dict[str, Any]:
    """JSON schema of a configuration file, which may hold any part of the whole."""
    whole = Configuration.model_json_schema()
    for part in (whole, *whole["$defs"].values()):
        part.pop("required", None)
    for named in ("Budget", "Task"):
        del whole["$defs"][named]["properties"]["name"]
    return whole


def _add_methods(overlay: Overlay) -> None:
    """Make each rule that the files do not speak of a method, like the paper's three."""
    methods = overlay.values.get("methods")
    for name in RULES:
        if isinstance(methods, dict) and name not in methods:
            constants = {"rule": name, "weight_mutation": "off"}
            overlay.add(("methods", name), constants, "neol/rules.py")


def _name(overlay: Overlay, loc: tuple[str, ...], name: str) -> None:
    """Give a task or budget its name, and a `gym:` task what Gymnasium knows of it."""
    content = overlay.values
    for key in loc:
        content = content.get(key, {}) if isinstance(content, dict) else {}
    if not isinstance(content, dict):
        return  # the types say what is wrong with it
    if "name" in content:
        source = overlay.source((*loc, "name"))
        raise UserError(f"{source}: {'.'.join(loc)}.name: unknown key, it is called {name} already")
    content["name"] = name
    if name.startswith("gym:"):
        for key, value in _gymnasium_constants(name).items():
            content.setdefault(key, value)


def _gymnasium_constants(task: str) -> dict[str, Any]:
    """The constants of the task `gym:ID`: what Gymnasium's registry says of the environment."""
    import gymnasium

    environment = task.removeprefix("gym:")
    if ":" in environment:
        raise UserError(
            f'task "{task}": no module is imported; register the environment and name it'
        )
    try:
        registered = gymnasium.spec(environment)
        if registered.max_episode_steps is None:  # as for what is gone, which making it tells
            with warnings.catch_warnings(action="ignore"):
                gymnasium.make(environment, disable_env_checker=True).close()
    except (gymnasium.error.Error, ImportError) as error:
        raise UserError(f'task "{task}": {" ".join(str(error).split())}') from None
    constants = {"environment": environment, "fresh_world": True}
    if registered.max_episode_steps is not None:
        constants["max_steps"] = registered.max_episode_steps
    return constants


def _sha256(content: Any) -> str:
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()


if __name__ == "__main__":
    (CONFIG / "schema.json").write_text(json.dumps(schema(), indent=2) + "\n", encoding="utf-8")
