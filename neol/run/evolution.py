"""Evolution: the generation loop of the paper's Algorithm 1, one generation at a time."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import Annotated

import numpy as np
import numpy.typing as npt

from neol.neat.decoding import decode, encode_weights
from neol.neat.genome import Genome, Pool
from neol.neat.population import Population
from neol.neat.reproduction import Reproduction
from neol.neat.species import SpeciesSet, speciate
from neol.network.forward import Networks
from neol.random.seeds import Stream, episode_seeds, generator, held_out_seeds
from neol.rollout.engine import Engine, Rollouts
from neol.spec.run_spec import RunSpec


@dataclass(frozen=True, slots=True)
class Generation:
    """What one generation came to: a row of a record. Each value has its unit and its meaning."""

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


@dataclass(slots=True)
class Evolution:
    """A run in progress. Its whole trajectory is a function of its spec.

    Between two steps the state is: an evaluated and speciated population, the counters, and the
    history. A step reproduces (but for the first), evaluates and speciates.
    """

    spec: RunSpec
    reproduction: Reproduction
    population: Population = field(default_factory=lambda: Population.of([]))
    species_set: SpeciesSet = field(default_factory=SpeciesSet)
    history: list[Generation] = field(default_factory=list)
    digest: str = ""
    """Hex digest of the trajectory so far: each generation's networks, returns and steps."""

    @classmethod
    def begin(cls, spec: RunSpec, inputs: int, outputs: int) -> "Evolution":
        """A run before its first generation, for a task with so many inputs and outputs."""
        return cls(spec, Reproduction(inputs, outputs, spec.neat), digest=spec.trajectory_key())

    @property
    def generation(self) -> int:
        """Generations completed."""
        return len(self.history)

    @property
    def finished(self) -> bool:
        """Whether the generations, or the optional budget of environment steps, are used up."""
        limit = self.spec.evaluation.step_limit
        used_up = limit is not None and bool(self.history) and self.history[-1].env_steps >= limit
        return self.generation >= self.spec.generations or used_up

    def run(self, engine: Engine) -> Iterator[Generation]:
        """Go on to the end, generation by generation (Algorithm 1, lines 2-5)."""
        while not self.finished:
            yield self.step(engine)

    def step(self, engine: Engine) -> Generation:
        """One generation: reproduce, evaluate, speciate."""
        number = self.generation + 1
        self.population = self._next_population(number)
        networks, gene = self._decode(self.population.pool)
        seeds = self._episode_seeds(number)
        rollouts = engine.evaluate(networks, seeds, self.spec.plasticity)
        worst = min((row.best_fitness for row in self.history), default=0.0)
        self.population.fitness = finite_fitness(rollouts, fallback=worst)
        learned = keep_inherited_where_failed(networks, rollouts)
        if self.spec.plasticity.write_back:
            encode_weights(self.population.pool, gene, learned)
        speciate(self.population, self.species_set, self.spec.neat)
        self.digest = _chain(self.digest, networks, rollouts)
        self.history.append(self._statistics(number, networks, rollouts, learned))
        return self.history[-1]

    def champion(self) -> Genome:
        """A copy of the final population's best genome, the oldest of equals (Algorithm 1)."""
        return self.population[int(np.argmax(self.population.fitness))].copy()

    def held_out_returns(self, engine: Engine) -> npt.NDArray[np.float64]:
        """The champion's returns in fresh episodes, plastic as in training: float64[episodes].

        Each episode starts from the champion's own weights, so each is a function of its seed.
        """
        seeds = held_out_seeds(self.spec.seed, self.spec.evaluation.held_out_episodes)
        networks, _ = self._decode(Pool.of([self.champion()] * seeds.size))
        returns: npt.NDArray[np.float64] = engine.evaluate(
            networks, seeds.reshape(-1, 1), self.spec.plasticity
        ).returns[:, 0]
        return returns

    def _next_population(self, number: int) -> Population:
        seed, size = self.spec.seed, self.spec.population
        if number == 1:
            return self.reproduction.initial_population(size, generator(seed, Stream.INITIAL))
        random = generator(seed, Stream.REPRODUCTION, number)
        return self.reproduction.reproduce(self.population, self.species_set, random)

    def _episode_seeds(self, number: int) -> npt.NDArray[np.uint64]:
        """Environment seeds of a generation: uint64[P, N]."""
        size, episodes = len(self.population), self.spec.evaluation.episodes
        if self.spec.evaluation.episode_seed == "fixed":
            return np.tile(np.arange(episodes, dtype=np.uint64), (size, 1))
        return episode_seeds(self.spec.seed, number, size, episodes)

    def _decode(self, pool: Pool) -> tuple[Networks, npt.NDArray[np.int64]]:
        inputs, outputs = self.reproduction.inputs, self.reproduction.outputs
        return decode(pool, inputs, outputs, self.spec.network)

    def _statistics(
        self,
        number: int,
        networks: Networks,
        rollouts: Rollouts,
        learned: npt.NDArray[np.float64],
    ) -> Generation:
        fitness = self.population.fitness
        best = int(np.argmax(fitness))
        nodes, connections = networks.node_offset, networks.edge_bounds
        change = np.abs(learned - networks.weight)
        before = self.history[-1] if self.history else None
        return Generation(
            generation=number,
            best_fitness=float(fitness[best]),
            mean_fitness=float(fitness.mean()),
            sd_fitness=float(fitness.std()),
            evaluations=len(fitness) + (before.evaluations if before else 0),
            env_steps=int(rollouts.steps.sum()) + (before.env_steps if before else 0),
            species=len(self.species_set.species),
            nodes_mean=int(nodes[-1]) / len(fitness),
            connections_mean=int(connections[-1]) / len(fitness),
            nodes_best=int(nodes[best + 1] - nodes[best]),
            connections_best=int(connections[best + 1] - connections[best]),
            weight_change_mean=float(change.mean()) if len(change) else 0.0,
            failed_evaluations=int(rollouts.failed.sum())
            + (before.failed_evaluations if before else 0),
        )


COLUMNS = tuple(column.name for column in fields(Generation))


def finite_fitness(rollouts: Rollouts, fallback: float) -> npt.NDArray[np.float64]:
    """Mean return of each network (Algorithm 2, line 16), float64[P].

    A failed evaluation gets the next number below the lowest fitness that another one of its
    generation came to: the worst, but no outlier that would decide how species share. Where all
    failed there is nothing to be below, and all get `fallback`.
    """
    fitness: npt.NDArray[np.float64] = rollouts.returns.mean(axis=1)
    if not rollouts.failed.any():
        return fitness
    if rollouts.failed.all():
        return np.full_like(fitness, fallback)
    lowest = fitness[~rollouts.failed].min()
    return np.where(rollouts.failed, np.nextafter(lowest, -np.inf), fitness)


def keep_inherited_where_failed(networks: Networks, rollouts: Rollouts) -> npt.NDArray[np.float64]:
    """The learned weights, float64[E], but for failed networks those that they began with."""
    if not rollouts.failed.any():
        return rollouts.weight
    failed = np.repeat(rollouts.failed, np.diff(networks.edge_bounds))
    return np.where(failed, networks.weight, rollouts.weight)


def _chain(digest: str, networks: Networks, rollouts: Rollouts) -> str:
    """The trajectory's digest after one more generation."""
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
