"""The generation loop: determinism, the champion, statistics, and that NEAT solves XOR."""

import math

import numpy as np
import numpy.typing as npt
import pytest

from neol.network.forward import Networks
from neol.random.seeds import Stream, generator
from neol.rollout.engine import Rollouts
from neol.rollout.reference import ReferenceEngine
from neol.run.evolution import Evolution, finite_fitness
from neol.spec.constants import Plasticity, Task
from tests.helpers.networks import outputs_of
from tests.helpers.runs import evolve, run_spec


@pytest.mark.parametrize("method", ["neat", "neat_wo", "hebb", "oja", "bcm"])
def test_same_spec_same_trajectory(method: str) -> None:
    one, other = evolve(run_spec(method)), evolve(run_spec(method))
    assert one.state.digest == other.state.digest
    assert one.state.history == other.state.history
    assert evolve(run_spec(method, seed=1)).state.digest != one.state.digest


def test_a_shorter_run_is_a_prefix_of_a_longer_one() -> None:
    short, long = evolve(run_spec()), evolve(run_spec(generations=7))
    assert long.state.history[:4] == short.state.history


def test_methods_meet_the_same_episodes_and_first_population() -> None:
    neat, neat_wo = evolve(run_spec("neat")), evolve(run_spec("neat_wo"))
    assert neat.state.history[0] == neat_wo.state.history[0]
    assert neat.state.history[1:] != neat_wo.state.history[1:]


def test_one_fixed_episode_is_the_same_for_all_evaluations_of_all_runs() -> None:
    asked = list[npt.NDArray[np.uint64]]()

    class Listening(ReferenceEngine):
        def evaluate(
            self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
        ) -> Rollouts:
            asked.append(seeds)
            return super().evaluate(networks, seeds, plasticity)

    for seed in (0, 1):
        overrides = "evaluation.episode_seed=fixed", "evaluation.episodes=2"
        spec = run_spec("neat", seed, *overrides, generations=2)
        list(Evolution.begin(spec, 4, 2).run(Listening(spec.task)))
    assert [seeds.tolist() for seeds in asked] == [[[0, 1]] * 8] * 4


def test_statistics_add_up() -> None:
    evolution = evolve(run_spec("hebb", 0, "evaluation.episodes=2"))
    last = evolution.state.history[-1]
    fitness = np.array([genome.fitness for genome in evolution.state.population])
    assert [row.generation for row in evolution.state.history] == [1, 2, 3, 4]
    assert last.best_fitness == fitness.max()
    assert last.mean_fitness == fitness.mean()
    assert last.sd_fitness == fitness.std()
    assert last.evaluations == 4 * 8
    steps = np.diff([0] + [row.env_steps for row in evolution.state.history])
    # CartPole pays 1 a step, so steps are N * P * mean fitness
    assert steps.tolist() == [round(2 * 8 * row.mean_fitness) for row in evolution.state.history]
    assert last.species == len(evolution.state.species_set.species)
    nodes = [len(genome.nodes) for genome in evolution.state.population]
    connections = [
        int(genome.connections["enabled"].sum()) for genome in evolution.state.population
    ]
    assert (last.nodes_mean, last.connections_mean) == (np.mean(nodes), np.mean(connections))
    best = int(fitness.argmax())
    assert (last.nodes_best, last.connections_best) == (nodes[best], connections[best])
    assert last.weight_change_mean > 0.0


def test_the_champion_is_a_copy_of_the_final_best() -> None:
    evolution = evolve(run_spec())
    champion = evolution.champion()
    best = next(g for g in evolution.state.population if g.id == champion.id)
    assert champion.fitness == evolution.state.history[-1].best_fitness == best.fitness
    best.connections["weight"] = 99.0
    assert (champion.connections["weight"] != 99.0).all()


def test_held_out_episodes_are_reproducible_and_change_nothing() -> None:
    evolution = evolve(run_spec())
    engine, digest = ReferenceEngine(evolution.spec.task), evolution.state.digest
    weights = evolution.champion().connections["weight"].copy()
    first = evolution.held_out_returns(engine)
    assert first.shape == (3,)
    assert (first == evolution.held_out_returns(engine)).all()
    assert (evolution.champion().connections["weight"] == weights).all()
    assert evolution.state.digest == digest


def test_write_back_decides_whether_learned_weights_are_inherited() -> None:
    def final_weights(write_back: str) -> npt.NDArray[np.float64]:
        spec = run_spec("oja", 0, f"plasticity.write_back={write_back}", generations=1)
        return np.concatenate([g.connections["weight"] for g in evolve(spec).state.population])

    inherited = final_weights("false")
    plain = run_spec("neat", generations=1)
    initial = np.concatenate([g.connections["weight"] for g in evolve(plain).state.population])
    assert (inherited == initial).all()
    assert (final_weights("true") != inherited).any()


def test_a_step_limit_ends_a_run_early() -> None:
    evolution = evolve(run_spec("neat", 0, "evaluation.step_limit=100", generations=50))
    assert evolution.state.history[-1].env_steps >= 100
    assert evolution.state.history[-2].env_steps < 100 if evolution.generation > 1 else True
    assert evolution.generation < 50


def test_a_failed_evaluation_is_the_worst() -> None:
    returns = np.array([[5.0, 7.0], [math.nan, math.nan], [-3.0, -1.0]])
    failed = np.array([False, True, False])
    steps, empty = np.zeros((3, 2), dtype=np.int64), np.zeros(0)
    fitness = finite_fitness(Rollouts(returns, steps, empty, empty, failed), fallback=-9.0)
    assert fitness[[0, 2]].tolist() == [6.0, -2.0]
    assert fitness[1] == np.nextafter(-2.0, -np.inf), "worse than any other, and hardly so"
    all_failed = Rollouts(returns[1:2], steps[1:2], empty, empty, failed[1:2])
    assert finite_fitness(all_failed, fallback=-9.0).tolist() == [-9.0]


class Generous(ReferenceEngine):
    """Plays CartPole, and replaces the first network's returns by a huge one."""

    def __init__(self, task: Task, huge: float) -> None:
        super().__init__(task)
        self.huge = huge

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        rollouts = super().evaluate(networks, seeds, plasticity)
        rollouts.returns[0] = self.huge
        return rollouts


@pytest.mark.parametrize("huge", [np.finfo(np.float64).max, -1e151])
def test_a_mean_return_that_is_too_large_is_a_failed_evaluation(huge: float) -> None:
    evolution = Evolution.begin(run_spec("oja", 0, "evaluation.episodes=2"), 4, 2)
    inherited = evolution.reproduction.initial_population(
        evolution.spec.population, generator(evolution.spec.seed, Stream.INITIAL)
    )
    row = evolution.step(Generous(evolution.spec.task, huge))
    first, *others = evolution.state.population
    assert row.failed_evaluations == 1
    assert first.fitness == np.nextafter(min(g.fitness for g in others), -np.inf)
    assert (first.connections == inherited[0].connections).all(), "it does not keep what it learned"
    assert row.best_fitness == max(genome.fitness for genome in others)
    assert np.isfinite([row.mean_fitness, row.sd_fitness]).all()


class XorEngine:
    """Fitness 4 minus the squared errors on the four cases; a right sign is a right answer."""

    name = "xor"
    cases = (((0.0, 0.0), -1.0), ((0.0, 1.0), 1.0), ((1.0, 0.0), 1.0), ((1.0, 1.0), -1.0))

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        fitness = [
            4.0
            - sum(
                ((outputs_of(networks, index, np.array(case))[0] - target) / 2) ** 2
                for case, target in self.cases
            )
            for index in range(networks.population)
        ]
        return Rollouts(
            returns=np.array(fitness).reshape(-1, 1),
            steps=np.full((networks.population, 1), 4),
            weight=networks.weight,
            threshold=np.zeros_like(networks.bias),
            failed=np.zeros(networks.population, dtype=np.bool_),
        )

    def close(self) -> None:
        pass


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_neat_solves_xor(seed: int) -> None:
    spec = run_spec("neat", seed, population=150, generations=150)
    evolution = Evolution.begin(spec, 2, 1)
    solved = next((row for row in evolution.run(XorEngine()) if row.best_fitness > 3.9), None)
    assert solved is not None
    assert solved.nodes_best > 1, "XOR needs a hidden node"
