"""Evolution: the generation loop of the paper's Algorithm 1, one generation at a time."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from neol.neat.decoding import decode, encode_weights
from neol.neat.genome import Genome, Pool
from neol.neat.innovations import Innovations
from neol.neat.population import Population
from neol.neat.reproduction import Reproduction
from neol.neat.species import SpeciesSet, remove_stagnant, speciate
from neol.network.forward import Networks
from neol.random.seeds import Stream, episode_seeds, generator, held_out_seeds
from neol.rollout.engine import Engine, Rollouts
from neol.spec.run_spec import RunSpec


@dataclass(frozen=True, slots=True)
class Generation:
    """Statistics of one generation: one row of a record. Each has its unit and its meaning."""

    generation: Annotated[int, "", "From 1."]
    best_fitness: Annotated[
        float, "return", "Highest fitness of the population: mean return over N episodes."
    ]
    mean_fitness: Annotated[float, "return", "Mean fitness of the population."]
    sd_fitness: Annotated[
        float, "return", "Standard deviation of the population's fitness (ddof = 0)."
    ]
    evaluations: Annotated[int, "genomes", "Genomes evaluated so far in the run."]
    env_steps: Annotated[
        int, "steps", "Environment steps so far in the run, held-out episodes left out."
    ]
    species: Annotated[int, "species", "Number of species."]
    nodes_mean: Annotated[float, "nodes", "Mean number of a genome's hidden and output nodes."]
    connections_mean: Annotated[
        float, "connections", "Mean number of a genome's enabled connections."
    ]
    nodes_best: Annotated[int, "nodes", "Hidden and output nodes of the best genome."]
    connections_best: Annotated[int, "connections", "Enabled connections of the best genome."]
    weight_change_mean: Annotated[
        float,
        "weight",
        "Mean |w after - w before| of an evaluation, over all connections of the population.",
    ]
    failed_evaluations: Annotated[
        int,
        "genomes",
        "Evaluations so far that met an observation, weight or sum of rewards that was not finite.",
    ]


class State(NamedTuple):
    """A run between two generations, as an immutable value."""

    population: Population
    """Evaluated population; empty before the first generation."""
    species_set: SpeciesSet
    innovations: Innovations
    history: tuple[Generation, ...]
    digest: str
    """Hex digest of the trajectory so far: networks, returns and steps of each generation."""


@dataclass(slots=True)
class Evolution:
    """A run in progress; its trajectory is a function of its spec.

    A step makes the next `state`: it reproduces (except the first), evaluates and speciates.
    """

    spec: RunSpec
    reproduction: Reproduction
    state: State

    @classmethod
    def begin(cls, spec: RunSpec, inputs: int, outputs: int) -> "Evolution":
        """Return a run before its first generation, for networks of the task's size."""
        reproduction = Reproduction(inputs, outputs, spec.neat)
        innovations = reproduction.first_innovations()
        state = State(Population.of([]), SpeciesSet(), innovations, (), spec.trajectory_key())
        return cls(spec, reproduction, state)

    @property
    def generation(self) -> int:
        """Number of completed generations."""
        return len(self.state.history)

    @property
    def finished(self) -> bool:
        """Whether the last generation or the optional limit of environment steps is reached."""
        limit, history = self.spec.evaluation.step_limit, self.state.history
        used_up = limit is not None and bool(history) and history[-1].env_steps >= limit
        return self.generation >= self.spec.generations or used_up

    def run(self, engine: Engine) -> Iterator[Generation]:
        """Continue to the end and yield each generation (Algorithm 1, lines 2-5)."""
        while not self.finished:
            yield self.step(engine)

    def step(self, engine: Engine) -> Generation:
        """Make one generation: reproduce, evaluate, speciate."""
        spec, history = self.spec, self.state.history
        population, species_set, innovations = self._reproduce()
        networks, gene = self._decode(population.pool)
        rollouts = engine.evaluate(networks, self._episode_seeds(), spec.plasticity)
        rollouts = fail_where_mean_is_too_large(rollouts)
        worst = min((row.best_fitness for row in history), default=0.0)
        population = replace(population, fitness=finite_fitness(rollouts, fallback=worst))
        learned = keep_inherited_where_failed(networks, rollouts)
        if spec.plasticity.write_back:
            encode_weights(population.pool, gene, learned)
        species_set = speciate(population, species_set, spec.neat)
        row = _statistics(history, population.fitness, species_set, networks, rollouts, learned)
        digest = _chain(self.state.digest, networks, rollouts)
        self.state = State(population, species_set, innovations, (*history, row), digest)
        return row

    def champion(self) -> Genome:
        """Copy the final population's best genome, the oldest of equals (Algorithm 1)."""
        population = self.state.population
        return population[int(np.argmax(population.fitness))].copy()

    def held_out_returns(self, engine: Engine) -> npt.NDArray[np.float64]:
        """Return the champion's returns in held-out episodes, float64[episodes].

        It learns as in training. Each episode starts from the champion's own weights, so each
        return is a function of its seed.
        """
        seeds = held_out_seeds(self.spec.seed, self.spec.evaluation.held_out_episodes)
        networks, _ = self._decode(Pool.of([self.champion()] * seeds.size))
        returns: npt.NDArray[np.float64] = engine.evaluate(
            networks, seeds.reshape(-1, 1), self.spec.plasticity
        ).returns[:, 0]
        return returns

    def _reproduce(self) -> tuple[Population, SpeciesSet, Innovations]:
        """Return the next generation's genomes, the remaining species and the used numbers."""
        seed, (population, species_set, innovations, *_) = self.spec.seed, self.state
        if self.generation == 0:
            random = generator(seed, Stream.INITIAL)
            first = self.reproduction.initial_population(self.spec.population, random)
            return first, species_set, innovations
        random = generator(seed, Stream.REPRODUCTION, self.generation + 1)
        left = remove_stagnant(species_set, population.fitness, self.spec.neat)
        children, innovations = self.reproduction.reproduce(population, left, innovations, random)
        return children, left, innovations

    def _episode_seeds(self) -> npt.NDArray[np.uint64]:
        """Return the environment seeds of the next generation: uint64[P, N]."""
        size, episodes = self.spec.population, self.spec.evaluation.episodes
        if self.spec.evaluation.episode_seed == "fixed":
            return np.tile(np.arange(episodes, dtype=np.uint64), (size, 1))
        return episode_seeds(self.spec.seed, self.generation + 1, size, episodes)

    def _decode(self, pool: Pool) -> tuple[Networks, npt.NDArray[np.int64]]:
        inputs, outputs = self.reproduction.inputs, self.reproduction.outputs
        return decode(pool, inputs, outputs, self.spec.network)


COLUMNS = tuple(column.name for column in fields(Generation))
LARGEST_RETURN = 1e150
"""Largest magnitude of a mean return, so that sums of squares over a population stay finite."""


def mean_returns(rollouts: Rollouts) -> npt.NDArray[np.float64]:
    """Return the mean return of each network, float64[P]: inf or NaN if it overflows."""
    with np.errstate(over="ignore", invalid="ignore"):
        means: npt.NDArray[np.float64] = rollouts.returns.mean(axis=1)
    return means


def fail_where_mean_is_too_large(rollouts: Rollouts) -> Rollouts:
    """Mark networks as failed whose mean return is not a number, or beyond `LARGEST_RETURN`."""
    ordinary = np.abs(mean_returns(rollouts)) <= LARGEST_RETURN
    return replace(rollouts, failed=rollouts.failed | ~ordinary)


def finite_fitness(rollouts: Rollouts, fallback: float) -> npt.NDArray[np.float64]:
    """Return the mean return of each network (Algorithm 2, line 16), float64[P].

    A failed evaluation gets the next number below the generation's lowest finite fitness: ranked
    last, but not an outlier that would distort fitness sharing. If all failed, all get `fallback`.
    """
    fitness = mean_returns(rollouts)
    if not rollouts.failed.any():
        return fitness
    if rollouts.failed.all():
        return np.full_like(fitness, fallback)
    lowest = fitness[~rollouts.failed].min()
    return np.where(rollouts.failed, np.nextafter(lowest, -np.inf), fitness)


def keep_inherited_where_failed(networks: Networks, rollouts: Rollouts) -> npt.NDArray[np.float64]:
    """Return the learned weights, float64[E]; failed networks keep their inherited weights."""
    if not rollouts.failed.any():
        return rollouts.weight
    failed = np.repeat(rollouts.failed, np.diff(networks.edge_bounds))
    return np.where(failed, networks.weight, rollouts.weight)


def _statistics(
    history: Sequence[Generation],
    fitness: npt.NDArray[np.float64],
    species_set: SpeciesSet,
    networks: Networks,
    rollouts: Rollouts,
    learned: npt.NDArray[np.float64],
) -> Generation:
    best = int(np.argmax(fitness))
    nodes, connections = networks.node_offset, networks.edge_bounds
    change = np.abs(learned - networks.weight)
    before = history[-1] if history else None
    return Generation(
        generation=len(history) + 1,
        best_fitness=float(fitness[best]),
        mean_fitness=float(fitness.mean()),
        sd_fitness=float(fitness.std()),
        evaluations=len(fitness) + (before.evaluations if before else 0),
        env_steps=int(rollouts.steps.sum()) + (before.env_steps if before else 0),
        species=len(species_set.species),
        nodes_mean=int(nodes[-1]) / len(fitness),
        connections_mean=int(connections[-1]) / len(fitness),
        nodes_best=int(nodes[best + 1] - nodes[best]),
        connections_best=int(connections[best + 1] - connections[best]),
        weight_change_mean=float(change.mean()) if len(change) else 0.0,
        failed_evaluations=int(rollouts.failed.sum())
        + (before.failed_evaluations if before else 0),
    )


def _chain(digest: str, networks: Networks, rollouts: Rollouts) -> str:
    """Return the trajectory's digest after one more generation."""
    chain = hashlib.sha256(digest.encode())
    for array in (
        networks.node_offset,
        networks.bias,
        networks.edge_offset,
        networks.source,
        networks.weight,
        rollouts.returns,
        rollouts.steps,
        rollouts.weight,
    ):
        chain.update(np.ascontiguousarray(array).data)
    return chain.hexdigest()
