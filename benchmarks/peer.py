"""The peer: a plain implementation of the same algorithm on neat-python and Gymnasium.

The network, its plasticity and the loop over steps are plain Python on neat-python's own
FeedForwardNetwork; NEAT is neat-python's. neat-python is no dependency of neol: `make bench`
installs it from benchmarks/requirements.lock. Where there was a choice the faster one was taken:
observations are lists of floats, the environment is made once (neol gives each episode of
BipedalWalker a new one), Gymnasium's checker is off.
"""

import math
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
import numpy as np

from neol.base.errors import UserError
from neol.random.seeds import episode_seeds
from neol.spec.constants import Plasticity
from neol.spec.run_spec import RunSpec

try:
    import neat
except ModuleNotFoundError:
    raise UserError(
        "the peer needs neat-python: make bench, or pip install -r benchmarks/requirements.lock"
    ) from None


class PeerRun(NamedTuple):
    """Result of a run of the peer."""

    steps: int
    """Environment steps."""
    seconds: float
    """CPU time of this process."""
    best_fitness: float


def run_spec(spec: RunSpec) -> PeerRun:
    """Run a specification, as far as neat-python has its constants."""
    start = time.process_time()
    environment = gymnasium.make(
        spec.task.environment, max_episode_steps=spec.task.max_steps, disable_env_checker=True
    )
    config = configuration(spec, environment)
    generation = steps = 0

    def evaluate(genomes: list[tuple[int, Any]], config: Any) -> None:
        nonlocal generation, steps
        generation += 1
        seeds = episode_seeds(spec.seed, generation, len(genomes), spec.evaluation.episodes)
        for (_, genome), row in zip(genomes, seeds.tolist(), strict=True):
            returns = []
            for episode_seed in row:
                network = neat.nn.FeedForwardNetwork.create(genome, config)
                total, length = play(environment, network, episode_seed, spec.plasticity)
                returns.append(total)
                steps += length
                if spec.plasticity.write_back and spec.plasticity.learns:
                    write_back(genome, network)
            genome.fitness = sum(returns) / len(returns)

    best = neat.Population(config, seed=spec.seed).run(evaluate, spec.generations)
    environment.close()
    return PeerRun(steps, time.process_time() - start, best.fitness)


def play(environment: Any, network: Any, seed: int, plasticity: Plasticity) -> tuple[float, int]:
    """Play one episode (Algorithm 2, lines 3-14); return its return and its steps."""
    space = environment.action_space
    discrete = isinstance(space, gymnasium.spaces.Discrete)
    gate = plasticity.learning_rate * plasticity.reward_scale
    threshold = {node: 0.0 for node, *_ in network.node_evals}
    observation, _ = environment.reset(seed=seed)
    total, steps, done = 0.0, 0, False
    while not done:
        outputs = network.activate(observation.tolist())
        if discrete:
            action = outputs.index(max(outputs))
        else:
            action = np.clip(outputs, space.low, space.high).astype(space.dtype)
        observation, reward, terminated, truncated, _ = environment.step(action)
        total += float(reward)
        steps += 1
        done = terminated or truncated
        if plasticity.learns:
            learn(network, plasticity, gate * float(reward), threshold)
    return total, steps


def learn(network: Any, plasticity: Plasticity, gate: float, threshold: dict[int, float]) -> None:
    """Apply Equations (1) to (3) to every connection (Algorithm 2, line 11)."""
    values, rule, limit = network.values, plasticity.rule, plasticity.weight_limit
    for node, _, _, _, _, links in network.node_evals:
        y = values[node]
        theta = threshold[node]
        for i, (source, w) in enumerate(links):
            x = values[source]
            if rule == "hebb":
                w += gate * x * y
            elif rule == "oja":
                w += gate * y * (x - y * w)
            else:
                w += gate * y * (y - theta) * x
            links[i] = (source, min(max(w, -limit), limit))
        if rule == "bcm":
            threshold[node] = theta + plasticity.threshold_rate * (y * y - theta)


def write_back(genome: Any, network: Any) -> None:
    """Give the genome the weights that its network has learned (Section 4.1)."""
    for node, _, _, _, _, links in network.node_evals:
        for source, weight in links:
            genome.connections[source, node].weight = weight


def configuration(spec: RunSpec, environment: Any) -> Any:
    """Return neat-python's configuration, through the file that it requires."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "config"
        path.write_text(config_text(spec, environment))
        config = neat.Config(
            neat.DefaultGenome,
            neat.DefaultReproduction,
            neat.DefaultSpeciesSet,
            neat.DefaultStagnation,
            str(path),
        )
    limit = spec.network.sum_limit
    config.genome_config.add_activation(  # its own tanh is tanh(2.5 x)
        "clipped_tanh", lambda total: math.tanh(min(max(total, -limit), limit))
    )
    return config


def config_text(spec: RunSpec, environment: Any) -> str:
    """Return the specification's constants under neat-python's names."""
    c = spec.neat
    space = environment.action_space
    outputs = space.n if isinstance(space, gymnasium.spaces.Discrete) else space.shape[0]
    off = c.weight_mutation == "off"
    config = c.weight_mutation == "config"
    weight_rate = 0.0 if off else c.weight_mutate_rate if config else c.weight_mutation
    bias_rate = 0.0 if off else c.bias_mutate_rate if config else c.weight_mutation
    return f"""
[NEAT]
fitness_criterion = max
fitness_threshold = 0
no_fitness_termination = True
pop_size = {spec.population}
reset_on_extinction = False

[DefaultGenome]
num_inputs = {environment.observation_space.shape[0]}
num_outputs = {outputs}
num_hidden = 0
feed_forward = True
initial_connection = full_direct
compatibility_disjoint_coefficient = {c.disjoint_coefficient}
compatibility_weight_coefficient = {c.weight_coefficient}
conn_add_prob = {c.add_connection_rate}
conn_delete_prob = {c.remove_connection_rate}
node_add_prob = {c.add_node_rate}
node_delete_prob = {c.remove_node_rate}
single_structural_mutation = False
structural_mutation_surer = False
activation_default = clipped_tanh
activation_mutate_rate = 0.0
activation_options = clipped_tanh
aggregation_default = sum
aggregation_mutate_rate = 0.0
aggregation_options = sum
bias_init_mean = 0.0
bias_init_stdev = {c.bias_init_sd}
bias_init_type = gaussian
bias_max_value = {c.bias_limit}
bias_min_value = {-c.bias_limit}
bias_mutate_power = {c.bias_mutate_power}
bias_mutate_rate = {bias_rate}
bias_replace_rate = {c.bias_replace_rate if config else 0.0}
response_init_mean = 1.0
response_init_stdev = 0.0
response_init_type = gaussian
response_max_value = 1.0
response_min_value = 1.0
response_mutate_power = 0.0
response_mutate_rate = 0.0
response_replace_rate = 0.0
weight_init_mean = 0.0
weight_init_stdev = {c.weight_init_sd}
weight_init_type = gaussian
weight_max_value = {c.weight_limit}
weight_min_value = {-c.weight_limit}
weight_mutate_power = {c.weight_mutate_power}
weight_mutate_rate = {weight_rate}
weight_replace_rate = {c.weight_replace_rate if config else 0.0}
enabled_default = True
enabled_mutate_rate = {c.enabled_mutate_rate}
enabled_rate_to_true_add = 0.0
enabled_rate_to_false_add = 0.0

[DefaultSpeciesSet]
compatibility_threshold = {c.compatibility_threshold}

[DefaultStagnation]
species_fitness_func = max
max_stagnation = {c.max_stagnation}
species_elitism = {c.species_elitism}

[DefaultReproduction]
elitism = {c.elitism}
survival_threshold = {c.survival_threshold}
min_species_size = {c.min_species_size}
"""
