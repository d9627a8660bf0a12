"""Replay of a champion: episodes of its record or new ones, step by step."""

import contextlib
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from neol.base.errors import UserError
from neol.neat.decoding import decode
from neol.neat.genome import Genome, Pool
from neol.network.forward import Networks
from neol.network.rules import NO_RULE
from neol.random.seeds import held_out_seeds
from neol.rollout import make_engine
from neol.rollout.environment import network_size
from neol.rollout.reference import Observer, ReferenceEngine, Step
from neol.run.record import Record, SeedInfo
from neol.run.record_file import read_record
from neol.spec.run_spec import RunSpec

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Trace:
    """An episode of T steps by a network of I inputs, M computed nodes and E connections."""

    observations: Floats
    """float64[T, I]: the observation that each action was chosen from."""
    activities: Floats
    """float64[T, M]: activities of hidden nodes, then of outputs, that chose each action."""
    actions: npt.NDArray[np.generic]
    """[T], or [T, A] for continuous actions: as passed to the environment."""
    rewards: Floats
    """float64[T]."""
    weights: Floats
    """float64[T + 1, E]: before the episode and after each step."""
    thresholds: Floats
    """float64[T + 1, M]: BCM's theta, before the episode and after each step."""
    episode_return: float
    """Sum of the rewards; NaN if the episode failed."""

    def __len__(self) -> int:
        return len(self.rewards)


@dataclass(frozen=True, slots=True)
class Player:
    """A champion with the specification of its run, which says how it plays and learns."""

    spec: RunSpec
    genome: Genome
    network: Networks
    """Batch of one network; every episode begins with its weights."""
    recorded_returns: tuple[float, ...]
    """Returns of the record's held-out episodes; NaN where one failed."""

    @property
    def held_out_seeds(self) -> tuple[int, ...]:
        """Seeds of the record's held-out episodes."""
        return tuple(held_out_seeds(self.spec.seed, len(self.recorded_returns))[0].tolist())

    def play(
        self,
        seed: int,
        *,
        plastic_steps: int | None = None,
        engine: ReferenceEngine | None = None,
        observe: Observer | None = None,
    ) -> Trace:
        """Play the episode of a seed in Gymnasium, whichever engine the run used.

        `plastic_steps` is the step after which plasticity stops. `observe` is called with each
        step. `engine` is an engine of this task with a render mode, or one to be reused.
        """
        recorder = _Recorder(self.network)

        def see(step: Step) -> None:
            recorder(step)
            if observe is not None:
                observe(step)

        with contextlib.ExitStack() as opened:
            if engine is None:
                engine = opened.enter_context(contextlib.closing(ReferenceEngine(self.spec.task)))
            total = engine.watch(self.network, seed, self.spec.plasticity, see, plastic_steps)
        return recorder.trace(total)

    def evaluate(self, seeds: npt.ArrayLike, *, plastic: bool = True) -> Floats:
        """Return the returns of some seeds' episodes on the fastest engine: float64[episodes].

        Each episode begins with the champion's own weights, as held-out ones do, and keeps them
        where it is not `plastic`. NaN: failed.
        """
        column = np.asarray(seeds, dtype=np.uint64).reshape(-1, 1)
        inputs, outputs = self.network.inputs, self.network.outputs
        pool = Pool.of([self.genome] * len(column))
        networks, _ = decode(pool, inputs, outputs, self.spec.network)
        plasticity = self.spec.plasticity
        if not plastic:
            plasticity = plasticity.model_copy(update={"rule": NO_RULE, "learning_rate": 0.0})
        with contextlib.closing(make_engine(self.spec.task)) as engine:
            returns: Floats = engine.evaluate(networks, column, plasticity).returns[:, 0]
        return returns


def load_champion(record: Path | str, seed: int | None = None) -> Player:
    """Load the champion of one of a record's runs, by default of the first.

    Raises UserError for a record that cannot be read, does not hold the seed, or was made with
    another environment of the same name.
    """
    read = read_record(Path(record))
    try:
        return _player(read, read.info(read.seeds[0].seed if seed is None else seed))
    except UserError as error:
        raise UserError(f"{record}: {error}") from None


def _player(record: Record, info: SeedInfo) -> Player:
    spec, genome = record.spec_of(info.seed), info.champion.genome()
    here = network_size(spec.task)
    if (info.inputs, info.outputs) != here:
        raise UserError(
            f"its networks have {info.inputs} inputs and {info.outputs} outputs, "
            f"{spec.task.environment} needs {here[0]} and {here[1]}; "
            "restore it, or install the environment that it was made with"
        )
    network, _ = decode(Pool.of([genome]), info.inputs, info.outputs, spec.network)
    returns = [math.nan if value is None else value for value in info.held_out.returns]
    return Player(spec, genome, network, tuple(returns))


class _Recorder:
    """Recorder that copies every step of an episode."""

    def __init__(self, network: Networks) -> None:
        self._network = network
        self._values: list[Floats] = []
        self._actions: list[Any] = []
        self._rewards: list[float] = []
        self._weights = [network.weight.copy()]
        self._thresholds = [np.zeros_like(network.bias)]

    def __call__(self, step: Step) -> None:
        self._values.append(step.values.copy())
        self._actions.append(step.action)
        self._rewards.append(step.reward)
        self._weights.append(step.weight.copy())
        self._thresholds.append(step.threshold.copy())

    def trace(self, episode_return: float) -> Trace:
        """Return the recorded episode."""
        inputs = self._network.inputs
        values = np.array(self._values).reshape(-1, inputs + len(self._network.bias))
        return Trace(
            observations=values[:, :inputs],
            activities=values[:, inputs:],
            actions=np.array(self._actions),
            rewards=np.array(self._rewards),
            weights=np.array(self._weights),
            thresholds=np.array(self._thresholds),
            episode_return=episode_return,
        )
