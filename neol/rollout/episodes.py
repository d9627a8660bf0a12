"""Algorithm 2 in compiled code: networks play episodes of a world and learn in them.

A world is a NamedTuple of numbers and arrays with kernels as methods (see `World`). It has room
for K episodes at once, its slots: each holds an episode of one network, and takes the network's
next one or the batch's next network when that has ended. An episode is a function of its seed and
network alone, so results depend neither on K nor on who plays beside whom.

The loop is written once, here, and compiled into the `play` of each class of worlds with its
`reset` and `step` inlined; each of these has its cache beside its own class, and loads nothing of
the others.
"""

import math
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
from numba import types
from numba.extending import intrinsic, overload_method, register_jitable

from neol.network.forward import Networks, forward
from neol.network.plasticity import Learning, learn
from neol.random.pcg64 import State, seed_pcg64
from neol.rollout.engine import Rollouts, learning_of
from neol.spec.constants import Plasticity

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Booleans = npt.NDArray[np.bool_]

STEPS_OF_A_CALL = 2**14
"""After so many a kernel returns to Python, where Ctrl-C is heard: within a second or two."""


class World(Protocol):
    """K environments of a kind in compiled code: a NamedTuple with these kernels as methods."""

    def reset(self, slot: int, random: State, observation: Floats) -> None:
        """Begin an episode in a slot with draws from a random stream.

        Writes the slot's row of the observations, float64[K, inputs].
        """

    def step(
        self,
        playing: Integers,
        outputs: Floats,
        observation: Floats,
        reward: Floats,
        ended: Booleans,
    ) -> None:
        """Act in the slots that play by their networks' outputs, float64[K, outputs].

        Writes their rows of the observations, their rewards and whether their episodes ended.
        """

    def play(self, batch: "Batch", slots: "Slots") -> None:
        """Let the networks of a batch play here: play_batch(self, batch, slots)."""


@overload_method(types.BaseNamedTuple, "reset")
def _reset(self, slot, random, observation):  # type: ignore[no-untyped-def]  # noqa: ARG001
    method = self.instance_class.reset
    return lambda self, slot, random, observation: method(self, slot, random, observation)


@overload_method(types.BaseNamedTuple, "step")
def _step(self, playing, outputs, observation, reward, ended):  # type: ignore[no-untyped-def]  # noqa: ARG001
    method = self.instance_class.step
    return lambda self, playing, outputs, observation, reward, ended: method(
        self, playing, outputs, observation, reward, ended
    )


class Batch(NamedTuple):
    """Networks that are to play, and what comes of it (`neol.rollout.engine.Rollouts`)."""

    networks: Networks
    """Their weights change as they learn."""
    learning: Learning
    inherited_weight: Floats
    """float64[E]."""
    write_back: bool
    max_steps: int
    seeds: npt.NDArray[np.uint64]
    """uint64[P, N]."""
    returns: Floats
    steps: Integers
    failed: Booleans
    next: Integers
    """int64[1]: the network that plays next, in whichever thread."""

    @classmethod
    def of(
        cls,
        networks: Networks,
        seeds: npt.NDArray[np.uint64],
        plasticity: Plasticity,
        max_steps: int,
        rollouts: Rollouts,
    ) -> "Batch":
        """Networks before their first episode; the results go to `rollouts`."""
        return cls(
            networks._replace(weight=rollouts.weight),
            learning_of(plasticity, rollouts.threshold),
            networks.weight,
            plasticity.write_back,
            max_steps,
            seeds,
            rollouts.returns,
            rollouts.steps,
            rollouts.failed,
            np.zeros(1, dtype=np.int64),
        )


class Slots(NamedTuple):
    """How far the episodes in K slots are: what `play_batch` knows from one call to the next."""

    playing: Integers
    """int64[K]: the slots, first those in use."""
    used: Integers
    """int64[1]: how many are in use."""
    network: Integers
    """int64[K]: who plays."""
    left: Integers
    """int64[K]: how many episodes that network has yet to begin."""
    steps: Integers
    """int64[K]: of the episode so far."""
    total: Floats
    """float64[K]: its sum of rewards."""
    observation: Floats
    outputs: Floats
    reward: Floats
    ended: Booleans
    values: Floats
    """float64[K, nodes]: the activities of the network's nodes, as far as it has so many."""
    random: State
    """Room for a random stream."""

    @classmethod
    def empty(cls, number: int, networks: Networks) -> "Slots":
        """So many slots for any of these networks, none in use."""
        largest = np.diff(networks.node_offset).max(initial=0)
        return cls(
            np.arange(number),
            np.zeros(1, dtype=np.int64),
            np.zeros(number, dtype=np.int64),
            np.zeros(number, dtype=np.int64),
            np.zeros(number, dtype=np.int64),
            np.zeros(number),
            np.zeros((number, networks.inputs)),
            np.zeros((number, networks.outputs)),
            np.zeros(number),
            np.zeros(number, dtype=np.bool_),
            np.zeros((number, networks.inputs + largest)),
            np.zeros(4, dtype=np.uint64),
        )


@register_jitable
def play_batch(world: World, batch: Batch, slots: Slots) -> None:
    """Let a batch's networks play in a world until `STEPS_OF_A_CALL` or none is left.

    Other threads may do so too, each in a world and slots of its own.
    """
    used = slots.used[0]
    while used < len(slots.playing) and begin_episode(world, batch, slots, slots.playing[used]):
        used += 1
    steps = 0
    while used > 0 and steps < STEPS_OF_A_CALL:
        for slot in slots.playing[:used]:
            act(batch, slots, slot, slots.values[slot])
        world.step(
            slots.playing[:used], slots.outputs, slots.observation, slots.reward, slots.ended
        )
        steps += used
        for place in range(used - 1, -1, -1):
            slot = slots.playing[place]
            goes_on = take_in(batch, slots, slot, slots.values[slot])
            if not goes_on and not begin_episode(world, batch, slots, slot):
                used -= 1
                slots.playing[place] = slots.playing[used]
                slots.playing[used] = slot
    slots.used[0] = used


@register_jitable
def begin_episode(world: World, batch: Batch, slots: Slots, slot: int) -> bool:
    """Begin an episode in a slot, its network's next or another's: whether there was one."""
    population, episodes = batch.seeds.shape
    while True:
        if slots.left[slot] == 0:
            slots.network[slot] = take_next(batch.next)  # type: ignore[call-arg]
            if slots.network[slot] >= population:
                return False
            slots.left[slot] = episodes
        network = slots.network[slot]
        begin_learning(batch, network)
        seed_pcg64(batch.seeds[network, episodes - slots.left[slot]], slots.random)
        slots.left[slot] -= 1
        slots.steps[slot] = 0
        slots.total[slot] = 0.0
        world.reset(slot, slots.random, slots.observation)
        if all_finite(slots.observation[slot]):
            return True
        end_episode(batch, slots, slot, failed=True)


@register_jitable
def begin_learning(batch: Batch, network: int) -> None:
    """Set a network's thresholds, and its weights unless it keeps them, to where it starts from."""
    first, last = batch.networks.node_offset[network], batch.networks.node_offset[network + 1]
    if not batch.write_back:
        for edge in range(batch.networks.edge_offset[first], batch.networks.edge_offset[last]):
            batch.networks.weight[edge] = batch.inherited_weight[edge]
    for node in range(first, last):
        batch.learning.threshold[node] = 0.0


@register_jitable
def act(batch: Batch, slots: Slots, slot: int, values: Floats) -> None:
    """Compute a slot's outputs from its observation (Algorithm 2, lines 6-7)."""
    networks, network = batch.networks, slots.network[slot]
    for i in range(networks.inputs):
        values[i] = slots.observation[slot, i]
    forward(networks, network, values)
    nodes = networks.node_offset[network + 1] - networks.node_offset[network]
    first = networks.inputs + nodes - networks.outputs
    for i in range(networks.outputs):
        slots.outputs[slot, i] = values[first + i]


@register_jitable
def take_in(batch: Batch, slots: Slots, slot: int, values: Floats) -> bool:
    """Learn from the step that a slot has taken: whether its episode goes on."""
    reward = slots.reward[slot]
    slots.total[slot] += reward
    slots.steps[slot] += 1
    finite = learn(batch.networks, slots.network[slot], batch.learning, reward, values)
    failed = not (math.isfinite(slots.total[slot]) and finite)
    if not (failed or slots.ended[slot] or slots.steps[slot] >= batch.max_steps):
        if all_finite(slots.observation[slot]):
            return True
        failed = True
    end_episode(batch, slots, slot, failed)
    return False


@register_jitable
def end_episode(batch: Batch, slots: Slots, slot: int, failed: bool) -> None:
    """Write what a slot's episode came to; where it failed, its network begins no other."""
    network = slots.network[slot]
    episode = batch.seeds.shape[1] - slots.left[slot] - 1
    batch.steps[network, episode] = slots.steps[slot]
    if failed:
        batch.failed[network] = True
        slots.left[slot] = 0
    else:
        batch.returns[network, episode] = slots.total[slot]


@register_jitable
def all_finite(observation: Floats) -> bool:
    """Whether a network can be shown this observation."""
    finite = True
    for value in observation:
        finite &= math.isfinite(value)
    return finite


@intrinsic
def take_next(_typing_context, counter):  # type: ignore[no-untyped-def]
    """Add one to counter[0] and return what it was, in one go: threads may share the counter."""

    def generate(context, builder, _signature, values):  # type: ignore[no-untyped-def]
        place = context.make_array(counter)(context, builder, values[0]).data
        return builder.atomic_rmw("add", place, context.get_constant(types.int64, 1), "monotonic")

    return types.int64(counter), generate
