"""The constants of a configuration, a class for each of its sections.

The classes hold no values: `config/base.yaml` holds every constant with its source.
"""

from typing import Annotated, Literal

from pydantic import Field

from neol.network.rules import NO_RULE
from neol.spec.types import (
    EnvironmentName,
    ForEachTask,
    MethodName,
    Model,
    Name,
    NonNegativeFloat,
    NonNegativeInt,
    PopulationSize,
    PositiveFloat,
    PositiveInt,
    Probability,
    RuleName,
    Seeds,
    Several,
    TaskName,
    WeightMutation,
)


class Task(Model):
    """A Gymnasium environment and how long an episode of it may be (Section 4.1)."""

    name: TaskName
    """Its key under `tasks`; never written in a file."""
    environment: EnvironmentName
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
    activation_scale: PositiveFloat
    """And then multiplied by this: an output is tanh(activation_scale * sum)."""


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

    rule: Name
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
    episode_seed: Literal["own", "fixed"]
    """own: each episode has its own environment seed; fixed: all runs play the seeds 0 to N - 1."""
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
    crossover_enabled: Literal["random_parent", "stanley", "redraw_if_disabled"]
    """Whether a matching gene is enabled in the child.

    random_parent: as in either parent, with equal chance (neat-python 0.92). stanley: the
    same, and then disabled with `disable_rate` where either parent's is.
    redraw_if_disabled: disabled with `disable_rate` where either parent's is, otherwise enabled.
    """
    disable_rate: Probability
    """Of a gene disabled in either parent; random_parent does not use it."""
    add_connection_rate: Probability
    """m_l."""
    add_node_rate: Probability
    """m_n."""
    new_node_bias: Literal["zero", "drawn"]
    """Bias of a node that splits a connection; drawn: like those of generation 0."""
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
    representative: Literal["founder", "nearest"]
    """Of a species: its founder for life, or each generation the genome nearest to the last one."""
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


class Budget(Model):
    """How much a campaign spends."""

    name: Name
    """The name of its file; never written in it."""
    generations: ForEachTask
    """G: of any task, or for each."""
    seeds: Seeds
    """Those of each cell; a plain number says how many, from 0 on."""
    populations: Several[PopulationSize]
    learning_rates: Several[NonNegativeFloat]
    """Grid of eta for the methods with a rule."""
    tasks: Several[TaskName]
    methods: Several[MethodName]
    seeds_per_job: ForEachTask
    """Runs of a cell that one job of the workflow makes: of any task, or for each."""

    @property
    def seed_range(self) -> range:
        """The seeds of each cell."""
        chosen = self.seeds
        if isinstance(chosen, int):
            return range(chosen)
        return range(chosen.first, chosen.first + chosen.count)

    @property
    def seed_count(self) -> int:
        """How many seeds each cell has."""
        return len(self.seed_range)

    def generations_of(self, task: str) -> int:
        """G of a task's runs."""
        return _of_task(self.generations, task)

    def seeds_per_job_of(self, task: str) -> int:
        """How many runs one job makes of a task's cell."""
        return _of_task(self.seeds_per_job, task)


def _of_task(number: int | dict[str, int], task: str) -> int:
    return number if isinstance(number, int) else number[task]
