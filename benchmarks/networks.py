"""Networks for the measurements of engines: of the initial topology, and large ones."""

import numpy as np
import numpy.typing as npt

from benchmarks.trajectories import Recording, record
from neol.neat.decoding import decode
from neol.network.forward import ACTIVATIONS, Networks
from neol.random.seeds import episode_seeds
from neol.rollout.engine import Engine
from neol.run.evolution import Evolution
from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec

HIDDEN, CONNECTIONS = 30, 300

FIXED_TOPOLOGY = ("neat.add_connection_rate=0", "neat.add_node_rate=0")


def initial_topology(
    spec: RunSpec, engine: Engine, size: tuple[int, int], generations: int
) -> Networks:
    """Return a population of the initial topology with weights evolved for some generations.

    Unevolved ones fall or crash within a few steps, which is not what an engine mostly plays.
    """
    fixed = load_configuration("paper", FIXED_TOPOLOGY).run_spec(
        task=spec.task.name,
        method="neat",
        population=spec.population,
        learning_rate=None,
        generations=generations,
        seed=spec.seed,
    )
    evolution = Evolution.begin(fixed, *size)
    for _ in evolution.run(engine):
        pass
    return decode(evolution.state.population.pool, *size, spec.network)[0]


def large(spec: RunSpec, size: tuple[int, int], population: int) -> Networks:
    """Return random networks with 30 hidden nodes and 300 of all possible connections."""
    random = np.random.default_rng(0)
    inputs, outputs = size
    nodes = HIDDEN + outputs
    target, source = np.array(
        [(node, s) for node in range(nodes) for s in range(inputs + min(node, HIDDEN))]
    ).T
    chosen = [
        np.sort(random.choice(len(source), CONNECTIONS, replace=False)) for _ in range(population)
    ]
    incoming = np.concatenate([np.bincount(target[c], minlength=nodes) for c in chosen])
    return Networks(
        inputs=inputs,
        outputs=outputs,
        activation=ACTIVATIONS[spec.network.hidden_activation],
        sum_limit=spec.network.sum_limit,
        activation_scale=spec.network.activation_scale,
        node_offset=np.arange(population + 1) * nodes,
        bias=random.normal(size=population * nodes),
        edge_offset=np.concatenate([[0], np.cumsum(incoming)]),
        source=np.concatenate([source[c] for c in chosen]),
        weight=random.normal(size=population * CONNECTIONS),
    )


def recording_of(spec: RunSpec, engine: Engine, networks: Networks, steps: int) -> Recording:
    """Record episodes of these networks in turn until there are about `steps` steps.

    All networks play at least once: fewer episodes would not fill the engine's slots.
    """
    seeds = episode_seeds(spec.seed, 1, networks.population, 1)
    once = int(engine.evaluate(networks, seeds, spec.plasticity).steps.sum())
    count = max(networks.population, round(steps / once * networks.population))
    repeated = _cycle(networks, count)
    return record(
        spec.task, engine, repeated, episode_seeds(spec.seed, 2, count, 1), spec.plasticity
    )


def _cycle(networks: Networks, count: int) -> Networks:
    """Return `count` networks of the batch, repeated from its start if it is smaller."""
    rounds, rest = divmod(count, networks.population)
    return join([networks] * rounds + [networks.slice(0, rest)] * (rest > 0))


def join(batches: list[Networks]) -> Networks:
    """Join batches in order."""
    first = batches[0]
    return first._replace(
        node_offset=_offsets([batch.node_offset for batch in batches]),
        bias=np.concatenate([batch.bias for batch in batches]),
        edge_offset=_offsets([batch.edge_offset for batch in batches]),
        source=np.concatenate([batch.source for batch in batches]),
        weight=np.concatenate([batch.weight for batch in batches]),
    )


def _offsets(parts: list[npt.NDArray[np.int64]]) -> npt.NDArray[np.int64]:
    sizes = np.concatenate([np.diff(part) for part in parts])
    return np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(sizes)])
