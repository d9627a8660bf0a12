"""Algorithm 2 in compiled code: networks play episodes of a world and learn in them.

A world is a NamedTuple of numbers and arrays with kernels as methods (see `World`). It has K
slots: each holds one network's episode. When that ends, the slot takes the network's next episode
or the batch's next network. An episode is a function of its seed and network alone, so results
depend neither on K nor on the networks in other slots.

The loop is written once, here, and compiled into the `play` of each class of worlds with its
`reset` and `step` inlined. Each class has its own cache and does not load the others.
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
"""Steps after which a kernel returns to Python, which checks for Ctrl-C: a second or two."""


class World(Protocol):
    """K environments of one kind in compiled code: a NamedTuple with these kernels as methods."""

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
        """Take a step in each playing slot by its network's outputs, float64[K, outputs].

        Writes their rows of the observations, their rewards and whether their episodes ended.
        """

    def play(self, batch: "Batch", slots: "Slots") -> None:
        """Play the episodes of a batch: play_batch(self, batch, slots)."""


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
    """Networks to be evaluated, and their results (`neol.rollout.engine.Rollouts`)."""

    networks: Networks
    """Networks whose weights change as they learn."""
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
    """int64[1]: the network that plays next; shared by all threads."""

    @classmethod
    def of(
        cls,
        networks: Networks,
        seeds: npt.NDArray[np.uint64],
        plasticity: Plasticity,
        max_steps: int,
        rollouts: Rollouts,
    ) -> "Batch":
        """Prepare networks for their first episode; results are written to `rollouts`."""
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
    """State of the episodes in K slots, kept between two calls of `play_batch`."""

    playing: Integers
    """int64[K]: slots, those in use first."""
    used: Integers
    """int64[1]: number of slots in use."""
    network: Integers
    """int64[K]: network of each slot."""
    left: Integers
    """int64[K]: number of episodes that the network has not begun."""
    steps: Integers
    """int64[K]: steps of the episode so far."""
    total: Floats
    """float64[K]: sum of the episode's rewards so far."""
    observation: Floats
    outputs: Floats
    reward: Floats
    ended: Booleans
    values: Floats
    """float64[K, nodes]: activities of the network's nodes; the rest of a row is unused."""
    random: State
    """Scratch space for a random stream."""

    @classmethod
    def empty(cls, number: int, networks: Networks) -> "Slots":
        """Return unused slots, large enough for any of the networks."""
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
    """Play a batch's episodes in a world until `STEPS_OF_A_CALL` or until none is left.

    Several threads may play the same batch, each with its own world and slots.
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
    """Begin a slot's next episode, of its network or the next one; return whether one was left."""
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
    """Reset a network's thresholds and, without write-back, its weights."""
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
    """Learn from a slot's last step; return whether its episode continues."""
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
    """Write the result of a slot's episode; a failed network plays no further episode."""
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
    """Whether all numbers of an observation are finite."""
    finite = True
    for value in observation:
        finite &= math.isfinite(value)
    return finite


@intrinsic
def take_next(_typing_context, counter):  # type: ignore[no-untyped-def]
    """Add one to counter[0] atomically and return its old value; threads may share the counter."""

    def generate(context, builder, _signature, values):  # type: ignore[no-untyped-def]
        place = context.make_array(counter)(context, builder, values[0]).data
        return builder.atomic_rmw("add", place, context.get_constant(types.int64, 1), "monotonic")

    return types.int64(counter), generate
