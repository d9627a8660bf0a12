"""The constants of a configuration: one class for each section.

The classes hold no values: `config/base.yaml` holds every constant with its source.
"""

from typing import Annotated, Literal, TypeVar

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
    PartOfGrid,
    PartsOfGrids,
    Populations,
    PositiveFloat,
    PositiveInt,
    Probability,
    RuleName,
    SeedRange,
    Seeds,
    Several,
    TaskName,
    WeightMutation,
)


class Task(Model):
    """A Gymnasium environment with the step limit of an episode (Section 4.1)."""

    name: TaskName
    """Set from the key under `tasks`; never written in a file."""
    environment: EnvironmentName
    """Gymnasium id, without a module, so that a foreign file cannot cause an import."""
    max_steps: PositiveInt
    """T_max: limit of an episode in environment steps."""
    fresh_world: bool
    """Make a new environment for every episode, because its reset keeps state of the last one."""


class Network(Model):
    """The phenotype (Section 4.1, "Algorithm Protocol")."""

    hidden_activation: Literal["tanh", "relu", "sigmoid", "identity"]
    sum_limit: PositiveFloat
    """A node's sum is clipped to +- this before its activation."""
    activation_scale: PositiveFloat
    """Factor of the clipped sum: an output is tanh(activation_scale * sum)."""


class PlasticityConstants(Model):
    """Constants that all rules share (Section A.3)."""

    reward_scale: PositiveFloat
    """Reward scale (beta)."""
    threshold_rate: Annotated[float, Field(gt=0, le=1)]
    """Rate of the sliding threshold (alpha)."""
    weight_limit: PositiveFloat
    """A weight is clipped to +- this after every update."""
    write_back: bool
    """Write an episode's learned weights to the genome (Lamarckian inheritance)."""


class Plasticity(PlasticityConstants):
    """Plasticity of a run."""

    rule: Name
    """Plasticity rule; a record may name one that is unknown here, which no engine can play."""
    learning_rate: NonNegativeFloat
    """Learning rate (eta)."""

    @property
    def learns(self) -> bool:
        """Whether the run has a plasticity rule."""
        return self.rule != NO_RULE


class Evaluation(Model):
    """Evaluation of genomes (Algorithm 2) and of the champion."""

    episodes: Annotated[int, Field(ge=1, le=1_000)]
    """N: fitness is the mean return over N episodes."""
    episode_seed: Literal["own", "fixed"]
    """own: each episode has its own environment seed; fixed: all runs play the seeds 0 to N - 1."""
    held_out_episodes: Annotated[int, Field(ge=1, le=100_000)]
    """Number of held-out episodes that evaluate the champion."""
    step_limit: PositiveInt | None
    """Environment steps after which a run ends with its generation; null: no limit."""


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
    """How the child inherits whether a matching gene is enabled.

    random_parent: from either parent with equal chance (neat-python 0.92). stanley: the same,
    then disabled with `disable_rate` if it is disabled in either parent. redraw_if_disabled:
    disabled with `disable_rate` if it is disabled in either parent, otherwise enabled.
    """
    disable_rate: Probability
    """Probability that a gene disabled in either parent is disabled in the child.

    random_parent does not use it.
    """
    add_connection_rate: Probability
    """Rate of new connections (m_l)."""
    add_node_rate: Probability
    """Rate of new nodes (m_n)."""
    innovation: Literal["generation", "endpoints"]
    """Condition under which two new genes are the same gene.

    generation: the same mutation in one generation gives the same connection or node. endpoints:
    source and target identify a connection in the whole run, and every split makes a new node
    (neat-python 0.92).
    """
    new_node_bias: Literal["zero", "drawn"]
    """Bias of a node that splits a connection; drawn: as in the first generation."""
    remove_connection_rate: Probability
    remove_node_rate: Probability
    crossover_rate: Probability
    """Crossover rate (p_c)."""
    survival_threshold: Annotated[float, Field(gt=0, le=1)]
    """Fraction of a species that may become parents (rho)."""
    equal_parents: Literal["smaller", "random"]
    """Parent that passes on its structure at equal fitness: the smaller, older one, or either."""
    elitism: NonNegativeInt
    """Genomes of each species that are copied unchanged (E)."""
    min_species_size: PositiveInt
    disjoint_coefficient: NonNegativeFloat
    """Weight of disjoint and excess genes in the distance (c_1)."""
    weight_coefficient: NonNegativeFloat
    """Weight of the mean weight difference in the distance (c_3)."""
    compatibility_threshold: PositiveFloat
    """Largest distance within a species (delta_t)."""
    representative: Literal["founder", "nearest"]
    """Representative of a species: its founder, or the genome nearest to the last one."""
    distance: Literal["connections", "all_genes"]
    """Genes that count in the distance between two genomes.

    connections: as in Algorithm 3. all_genes: nodes count like connections, a flag that differs
    counts like a weight that differs by 1, and each sum is divided by the larger genome's number
    of such genes (neat-python 0.92).
    """
    distance_normaliser: Literal["matching", "larger_genome"]
    """N of the distance: the number of matching genes or the size of the larger genome.

    all_genes does not use it.
    """
    sharing: Literal["stanley", "literal"]
    max_stagnation: PositiveInt
    """Generations without a better best fitness before a species is removed (G_stag)."""
    species_elitism: NonNegativeInt
    """Number of best species that are never removed for stagnation."""

    @property
    def places_kept(self) -> int:
        """Least offspring of a species that has any (Algorithm 4, lines 3 and 8)."""
        return max(self.min_species_size, self.elitism)


class Neat(NeatConstants):
    """NEAT of a run."""

    weight_mutation: WeightMutation
    """WM_MODE: off (no value is mutated), config (the rates above) or a probability.

    A probability replaces both mutate rates, of weights and biases; then no value is replaced.
    """


class Method(Model):
    """What distinguishes NEAT, NEAT (w/o) and the rules of NEOL."""

    rule: RuleName
    weight_mutation: WeightMutation
    """WM_MODE: off, config or a probability."""

    @property
    def learns(self) -> bool:
        """Whether the method has a plasticity rule."""
        return self.rule != NO_RULE


class Budget(Model):
    """Size of a campaign."""

    name: Name
    """Set from the name of the file; never written in it."""
    generations: ForEachTask
    """Generations G: one number, or one for each task."""
    seeds: Seeds
    """Seeds of each cell: a number of seeds from 0 on, one for each task, or a range."""
    populations: Populations
    """Grid of P: one list, or one for each task."""
    learning_rates: Several[NonNegativeFloat]
    """Grid of eta for the methods with a rule."""
    tasks: Several[TaskName]
    methods: Several[MethodName]
    seeds_per_job: ForEachTask
    """Runs of a cell in one job of the workflow: one number, or one for each task."""
    configurations: PartsOfGrids = "grid"
    """Cells of the grid that are run: all, those of the paper's Tables 3 and 4, or of Table 4.

    One of these, or one for each task. Where a table names a population that the budget does not
    have, its largest is taken.
    """
    records_of: dict[TaskName, Name] = Field(default_factory=dict)
    """Tasks whose runs are part of another budget's, which keeps their records."""

    def seeds_of(self, task: str) -> range:
        """Return the seeds of a task's cells."""
        if isinstance(self.seeds, SeedRange):
            return range(self.seeds.first, self.seeds.first + self.seeds.count)
        return range(_of_task(self.seeds, task))

    def populations_of(self, task: str) -> tuple[int, ...]:
        """Return the population sizes P of a task's cells."""
        return _of_task(self.populations, task)

    def configurations_of(self, task: str) -> PartOfGrid:
        """Return which cells of a task's grid are run: grid, tables or table4."""
        return _of_task(self.configurations, task)

    @property
    def grid_tasks(self) -> list[str]:
        """Tasks of which all cells of the grid are run."""
        return [task for task in self.tasks if self.configurations_of(task) == "grid"]

    def generations_of(self, task: str) -> int:
        """Return the generations G of a task's runs."""
        return _of_task(self.generations, task)

    def seeds_per_job_of(self, task: str) -> int:
        """Return the number of runs of a task's cell in one job."""
        return _of_task(self.seeds_per_job, task)


Value = TypeVar("Value")


def _of_task(value: Value | dict[str, Value], task: str) -> Value:
    return value[task] if isinstance(value, dict) else value
