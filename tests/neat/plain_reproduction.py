"""A plain twin of reproduction: Algorithm 4 gene by gene, on dicts and lists.

It draws the numbers that neol draws, in the same order, from numpy's own streams.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from neol.spec.constants import Neat

Kind = Literal["weight", "bias"]


@dataclass
class Connection:
    source: int
    target: int
    weight: float
    enabled: bool = True


@dataclass
class PlainGenome:
    biases: dict[int, float]
    """Bias of output and hidden nodes, by id."""
    connections: dict[int, Connection] = field(default_factory=dict)
    """Connections by innovation number."""
    fitness: float = math.nan

    def copy(self) -> "PlainGenome":
        connections = {number: replace(gene) for number, gene in self.connections.items()}
        return PlainGenome(dict(self.biases), connections)

    def leads(self, start: int, goal: int) -> bool:
        """Whether a path leads from a node to another one, or they are the same."""
        reached, waiting = set[int](), [start]
        while waiting:
            node = waiting.pop()
            if node not in reached:
                reached.add(node)
                waiting += [c.target for c in self.connections.values() if c.source == node]
        return goal in reached


class PlainReproduction:
    """Maker of populations; the fitter, smaller, older parent passes on its structure."""

    def __init__(self, inputs: int, outputs: int, neat: Neat) -> None:
        self.inputs, self.outputs, self.neat = inputs, outputs, neat
        self.next_innovation, self.next_node = inputs * outputs, inputs + outputs

    def initial_population(self, size: int, random: np.random.Generator) -> list[PlainGenome]:
        """Connect every input to every output."""
        self.variation = new_stream(random)
        outputs = range(self.inputs, self.inputs + self.outputs)
        pairs = [(source, target) for target in outputs for source in range(self.inputs)]
        population = []
        for _ in range(size):
            weights, biases = self.fresh("weight", len(pairs)), self.fresh("bias", len(outputs))
            genome = PlainGenome(dict(zip(outputs, biases, strict=True)))
            for place, (pair, weight) in enumerate(zip(pairs, weights, strict=True)):
                number = of_endpoints(*pair) if self.neat.innovation == "endpoints" else place
                genome.connections[number] = Connection(*pair, weight)
            population.append(genome)
        return population

    def reproduce(
        self,
        population: list[PlainGenome],
        species: Sequence[Sequence[int]],
        adjusted: Sequence[float],
        random: np.random.Generator,
    ) -> list[PlainGenome]:
        """Make the next population from each species' members (best first) and F_adj."""
        neat, children = self.neat, list[PlainGenome]()
        self.connected, self.split = dict[tuple[int, int], int](), list[int]()
        self.variation = new_stream(random)
        spawns = spawn_counts(adjusted, len(population), neat)  # lines 1-4
        for members, spawn in zip(species, spawns, strict=True):
            elites = members[: min(neat.elitism, spawn)]
            children += [population[place].copy() for place in elites]  # lines 7-8
            top = members[: math.ceil(neat.survival_threshold * len(members))]  # lines 11-12
            pool = [population[place] for place in sorted(top)]
            pool.sort(key=lambda genome: (-genome.fitness, len(genome.connections)))
            rest = range(spawn - len(elites))
            pairs = [random.integers(len(pool), size=2).tolist() for _ in rest]  # line 15
            crossed = [random.random() < neat.crossover_rate for _ in rest]  # line 16
            for (p1, p2), both in zip(pairs, crossed, strict=True):
                fitter, other = self.ordered(pool, p1, p2 if both else p1)
                children.append(self.child(pool[fitter], pool[other]))
        self.next_innovation += len(self.connected)
        self.next_node += len(self.split)
        return children

    def ordered(self, pool: list[PlainGenome], p1: int, p2: int) -> tuple[int, int]:
        """Draw two parents from a sorted pool; the first one passes on its structure."""
        if self.neat.equal_parents == "smaller":
            return min(p1, p2), max(p1, p2)
        return (p1, p2) if pool[p1].fitness >= pool[p2].fitness else (p2, p1)

    def child(self, fitter: PlainGenome, other: PlainGenome) -> PlainGenome:
        """Make a child (lines 17-27)."""
        neat, child = self.neat, fitter.copy()
        if fitter is not other:
            self.cross(child, other)
        for rate, mutate in (
            (neat.add_connection_rate, self.add_connection),
            (neat.add_node_rate, self.add_node),
            (neat.remove_connection_rate, self.remove_connection),
            (neat.remove_node_rate, self.remove_node),
        ):
            if self.variation.random() < rate:
                mutate(child)
        genes = [child.connections[number] for number in sorted(child.connections)]
        for gene in genes:
            chance = self.variation.random()
            if chance < neat.enabled_mutate_rate:
                gene.enabled = chance < neat.enabled_mutate_rate / 2
        weights = self.mutated("weight", [gene.weight for gene in genes])
        for gene, weight in zip(genes, weights, strict=True):
            gene.weight = weight
        nodes = sorted(child.biases)
        biases = self.mutated("bias", [child.biases[node] for node in nodes])
        child.biases = dict(zip(nodes, biases, strict=True))
        return child

    def cross(self, child: PlainGenome, other: PlainGenome) -> None:
        """Take matching genes from either parent; a rule decides on genes disabled in either."""
        for number in sorted(child.connections.keys() & other.connections.keys()):
            ours, theirs = child.connections[number], other.connections[number]
            ours.enabled = self.flag(ours.enabled, theirs.enabled)
            if self.variation.random() < 0.5:
                ours.weight = theirs.weight
        for node in sorted(child.biases.keys() & other.biases.keys()):
            if self.variation.random() < 0.5:
                child.biases[node] = other.biases[node]

    def flag(self, ours: bool, theirs: bool) -> bool:
        rule, flag = self.neat.crossover_enabled, ours
        if ours and theirs:
            return True
        if rule == "redraw_if_disabled":
            return not self.variation.random() < self.neat.disable_rate
        if ours != theirs and not self.variation.random() < 0.5:
            flag = theirs
        if rule == "stanley" and self.variation.random() < self.neat.disable_rate:
            flag = False
        return flag

    def add_connection(self, child: PlainGenome) -> None:
        source = self.one_of([*range(self.inputs), *self.hidden(child)])
        target = self.one_of(sorted(child.biases))
        joined = any((c.source, c.target) == (source, target) for c in child.connections.values())
        if not joined and not child.leads(target, source):
            (weight,) = self.fresh("weight", 1)
            self.connect(child, source, target, weight)

    def add_node(self, child: PlainGenome) -> None:
        if enabled := [number for number, gene in child.connections.items() if gene.enabled]:
            number = self.one_of(sorted(enabled))
            if self.neat.innovation == "endpoints" or number not in self.split:
                self.split.append(number)
                node = self.next_node + len(self.split) - 1
            else:
                node = self.next_node + self.split.index(number)
            gene = child.connections[number]
            gene.enabled = False
            drawn = self.neat.new_node_bias == "drawn"
            (child.biases[node],) = self.fresh("bias", 1) if drawn else (0.0,)
            self.connect(child, gene.source, node, 1.0)
            self.connect(child, node, gene.target, gene.weight)

    def remove_connection(self, child: PlainGenome) -> None:
        if child.connections:
            del child.connections[self.one_of(sorted(child.connections))]

    def remove_node(self, child: PlainGenome) -> None:
        if hidden := self.hidden(child):
            node = self.one_of(hidden)
            del child.biases[node]
            for number, gene in list(child.connections.items()):
                if node in (gene.source, gene.target):
                    del child.connections[number]

    def hidden(self, genome: PlainGenome) -> list[int]:
        return [node for node in sorted(genome.biases) if node >= self.inputs + self.outputs]

    def connect(self, child: PlainGenome, source: int, target: int, weight: float) -> None:
        """Return equal numbers for equal new connections of a generation, or of the run."""
        if self.neat.innovation == "endpoints":
            number = of_endpoints(source, target)
        else:
            number = self.next_innovation + len(self.connected)
            number = self.connected.setdefault((source, target), number)
        child.connections[number] = Connection(source, target, weight)

    def mutated(self, what: Kind, values: list[float]) -> list[float]:
        """Mutate by WM_MODE (lines 22-27)."""
        mode, perturb, renew = self.neat.weight_mutation, 0.0, 0.0
        if mode == "config":
            perturb, renew = self.of(what, "mutate_rate"), self.of(what, "replace_rate")
        elif mode != "off":
            perturb = mode
        if perturb == renew == 0.0:
            return values
        mutated = []
        for value, noise in zip(values, self.normals(len(values)), strict=True):
            chance = self.variation.random()
            if chance < perturb:
                value = self.limited(what, value + self.of(what, "mutate_power") * noise)
            elif chance < perturb + renew:
                value = self.limited(what, self.of(what, "init_sd") * noise)
            mutated.append(value)
        return mutated

    def fresh(self, what: Kind, count: int) -> list[float]:
        sd = self.of(what, "init_sd")
        return [self.limited(what, sd * noise) for noise in self.normals(count)]

    def limited(self, what: Kind, value: float) -> float:
        limit = self.of(what, "limit")
        return limit if value > limit else -limit if value < -limit else value

    def of(self, what: Kind, constant: str) -> float:
        """Return a constant of weights or of biases."""
        number: float = getattr(self.neat, f"{what}_{constant}")
        return number

    def normals(self, count: int) -> list[float]:
        """Draw a normal number by Marsaglia's polar method."""
        normals: list[float] = []
        while len(normals) < count:
            x, y = (2.0 * self.variation.random(2) - 1.0).tolist()
            square = x * x + y * y
            if 0.0 < square < 1.0:
                scale = math.sqrt(-2.0 * math.log(square) / square)
                normals += [scale * x, scale * y]
        return normals[:count]

    def one_of(self, choices: Sequence[int]) -> int:
        return choices[int(len(choices) * self.variation.random())]


def of_endpoints(source: int, target: int) -> int:
    """Return a number that orders connections by target, then source."""
    return (target << 24) + source


def new_stream(random: np.random.Generator) -> np.random.Generator:
    """Return a stream that is seeded from another."""
    return np.random.default_rng(int(random.integers(2**64, dtype=np.uint64)))


def spawn_counts(adjusted: Sequence[float], size: int, neat: Neat) -> list[int]:
    """Return offspring counts (lines 1-4): rounded shares, then corrected by nearness to them."""
    total = sum(adjusted)
    shares = [size * each / total if total > 0 else size / len(adjusted) for each in adjusted]
    least = min(max(neat.min_species_size, neat.elitism), size)
    largest_first = sorted(range(len(shares)), key=lambda s: -shares[s])
    alive = sorted(largest_first[: size // least])  # all, unless there are too many for the least
    spawn = [0] * len(shares)
    for s in alive:
        spawn[s] = max(least, round(shares[s]))
    while sum(spawn) > size:
        spawn[max((s for s in alive if spawn[s] > least), key=lambda s: spawn[s] - shares[s])] -= 1
    while sum(spawn) < size:
        spawn[max(alive, key=lambda s: shares[s] - spawn[s])] += 1
    return spawn
