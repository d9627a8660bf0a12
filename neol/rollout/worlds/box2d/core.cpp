// The C interface of the core. A handle serves one thread at a time. Where a function returns 1 the
// episode is over; should Box2D have failed an assertion, its reward and observation are NaN.
#include <limits>

#include "bipedal_walker.hpp"
#include "lunar_lander.hpp"

#define NEOL_EXPORT extern "C" __attribute__((visibility("default")))

using neol::Simulation;

namespace {

template <class Work>
int guarded(Simulation* simulation, double* observation, double* reward, Work work) {
  try {
    return work();
  } catch (const b2AssertException&) {
    simulation->abandon();
    observation[0] = *reward = std::numeric_limits<double>::quiet_NaN();
    return 1;
  }
}

}  // namespace

// What the library was made from: see library.py.
NEOL_EXPORT const char* neol_stamp() { return NEOL_STAMP; }

// `task`: 0 LunarLander-v3, 1 BipedalWalker-v3, 2 BipedalWalkerHardcore-v3; else null.
NEOL_EXPORT Simulation* neol_create(int task) {
  if (task == 0) return new neol::LunarLander;
  if (task == 1 || task == 2) return new neol::BipedalWalker(task == 2);
  return nullptr;
}

NEOL_EXPORT void neol_destroy(Simulation* simulation) { delete simulation; }

// Starts the episode of a random stream: state and increment of PCG64, each high word first.
NEOL_EXPORT int neol_reset(Simulation* simulation, const std::uint64_t stream[4],
                           double* observation) {
  double reward;
  return guarded(simulation, observation, &reward, [=] {
    simulation->reset(neol::Pcg64(stream), observation);
    return 0;
  });
}

// `action`: LunarLander's one number, or BipedalWalker's four in [-1, 1].
NEOL_EXPORT int neol_step(Simulation* simulation, const float* action, double* observation,
                          double* reward) {
  return guarded(simulation, observation, reward,
                 [=] { return simulation->step(action, observation, reward); });
}

// For benchmarks: the physics alone of `steps` steps from here on, with `width` numbers for
// each action.
NEOL_EXPORT void neol_physics(Simulation* simulation, const float* actions, int width, int steps) {
  for (int i = 0; i < steps; ++i) simulation->advance(actions + i * width);
}
