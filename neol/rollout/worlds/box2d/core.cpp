// The C interface of the core: groups of simulations of one task, which serve one thread at a time.
// Arrays have a row for each slot of a group, unless said otherwise: `actions` float[slots][4],
// `observations` double[slots][], `rewards` double[slots], `ended` bool[slots]. Where Box2D fails
// an assertion, the slot's episode has ended with NaN as its reward and first observation.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "bipedal_walker.hpp"
#include "lockstep.hpp"
#include "lunar_lander.hpp"

#define NEOL_EXPORT extern "C" __attribute__((visibility("default")))

using neol::Path;
using neol::Simulation;

namespace {

constexpr int action_size = 4;
constexpr double failure = std::numeric_limits<double>::quiet_NaN();

struct Group {
  int observation_size;
  Path path;
  std::vector<std::unique_ptr<Simulation>> slots;
  std::vector<Simulation*> stepping;  // scratch memory of a step
  std::vector<const float*> acting;
};

void give_up(Simulation& simulation, double* observation) {
  simulation.abandon();
  observation[0] = failure;
}

std::unique_ptr<Simulation> simulation_of(int task) {
  if (task == 0) return std::make_unique<neol::LunarLander>();
  return std::make_unique<neol::BipedalWalker>(task == 2);
}

}  // namespace

// Digest of the sources and flags: `stamp` in library.py.
NEOL_EXPORT const char* neol_stamp() { return NEOL_STAMP; }

// Whether this machine has a path, by its number in `Path`.
NEOL_EXPORT bool neol_available(int path) { return neol::available(static_cast<Path>(path)); }

// The number of the fastest path that this machine has.
NEOL_EXPORT int neol_best_path() { return static_cast<int>(neol::best_path()); }

// `task`: 0 LunarLander-v3, 1 BipedalWalker-v3, 2 BipedalWalkerHardcore-v3.
NEOL_EXPORT Group* neol_create(int task, int slots, int path) {
  auto group = std::make_unique<Group>();
  group->observation_size = task == 0 ? 8 : 24;
  group->path = static_cast<Path>(path);
  for (int slot = 0; slot < slots; ++slot) group->slots.push_back(simulation_of(task));
  return group.release();
}

NEOL_EXPORT void neol_destroy(Group* group) { delete group; }

// Starts the episode of a random stream in a slot, whose first observation goes to `observation`.
// `stream`: state and increment of PCG64, each high word first.
NEOL_EXPORT void neol_reset(Group* group, std::int64_t slot, const std::uint64_t stream[4],
                            double* observation) {
  Simulation& simulation = *group->slots[static_cast<std::size_t>(slot)];
  try {
    simulation.reset(neol::Pcg64(stream), observation);
  } catch (const b2AssertException&) {
    simulation.failed = true;
    give_up(simulation, observation);
  }
}

// Takes a step in each of `count` different slots, those that `slots` lists. An action is
// LunarLander's one number, or BipedalWalker's four in [-1, 1].
NEOL_EXPORT void neol_step(Group* group, std::int64_t count, const std::int64_t* slots,
                           const float* actions, double* observations, double* rewards,
                           bool* ended) {
  group->stepping.clear();
  group->acting.clear();
  for (std::int64_t i = 0; i < count; ++i) {
    group->stepping.push_back(group->slots[static_cast<std::size_t>(slots[i])].get());
    group->acting.push_back(actions + slots[i] * action_size);
  }
  advance_all(group->path, group->stepping.data(), group->acting.data(), static_cast<int>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    Simulation& simulation = *group->stepping[static_cast<std::size_t>(i)];
    const std::int64_t slot = slots[i];
    double* observation = observations + slot * group->observation_size;
    if (simulation.failed) {
      give_up(simulation, observation);
      rewards[slot] = failure;
      ended[slot] = true;
    } else {
      ended[slot] =
          simulation.observe(actions + slot * action_size, observation, rewards + slot);
    }
  }
}

// For benchmarks: the next `steps` steps of Box2D's own physics in the first slot. An action has
// `width` numbers.
NEOL_EXPORT void neol_physics(Group* group, const float* actions, int width, int steps) {
  for (int i = 0; i < steps; ++i) group->slots.front()->advance(actions + i * width);
}
