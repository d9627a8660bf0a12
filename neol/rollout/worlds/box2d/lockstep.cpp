#include "lockstep.hpp"

#include <algorithm>
#include <vector>

#include "lanes.hpp"
#include "shortcut.hpp"

namespace neol {

namespace {

// A kind of vector.
struct Lanes {
  int width;
  void (*iterate)(Constraints* const* islands, int count, int iterations);
};

Lanes lanes_of(Path path) {
  switch (path) {
#if defined(__x86_64__)
    case Path::sse2:
      return {sse2::width, sse2::iterate};
    case Path::avx2:
      return {avx2::width, avx2::iterate};
    case Path::avx512:
      return {avx512::width, avx512::iterate};
#elif defined(__aarch64__)
    case Path::neon:
      return {neon::width, neon::iterate};
#endif
    default:
      return {1, nullptr};
  }
}

// Does a part of a step in a simulation that has not failed so far.
template <class Part>
void attempt(Simulation* simulation, Part part) {
  if (simulation->failed) return;
  try {
    part(*simulation);
  } catch (const b2AssertException&) {
    simulation->failed = true;
  }
}

bool has_slots(const Constraints& island) {
  int of_body[max_bodies] = {};
  for (int i = 0; i < island.contacts; ++i)
    if (++of_body[island.contact_body[i]] > contact_slots) return false;
  return true;
}

}  // namespace

bool available(Path path) {
  switch (path) {
    case Path::plain:
    case Path::shortcut:
      return true;
#if defined(__x86_64__)
    case Path::sse2:
      return true;
    case Path::avx2:
      return __builtin_cpu_supports("avx2");
    case Path::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512dq");
#elif defined(__aarch64__)
    case Path::neon:
      return true;
#endif
    default:
      return false;
  }
}

Path best_path() {
  for (const Path path : {Path::avx512, Path::avx2, Path::neon, Path::sse2})
    if (available(path)) return path;
  return Path::shortcut;
}

void advance_all(Path path, Simulation* const* simulations, const float* const* actions,
                 int count) {
  if (path == Path::plain) {
    for (int i = 0; i < count; ++i)
      attempt(simulations[i], [&](Simulation& simulation) { simulation.advance(actions[i]); });
    return;
  }

  constexpr int worth_it = 3;  // fewer worlds are faster one by one
  const Lanes lanes = lanes_of(path);
  std::vector<Constraints*> together;
  for (int i = 0; i < count; ++i)
    attempt(simulations[i], [&](Simulation& simulation) {
      simulation.act(actions[i]);
      TimeStep& step = simulation.time_step;
      if (!step.begin(simulation.seconds, simulation.velocity_iterations,
                      simulation.position_iterations))
        return;
      if (lanes.width > 1 && has_slots(step.island))
        together.push_back(&step.island);
      else
        iterate(step.island, simulation.velocity_iterations);
    });
  // Worlds with as many contacts keep company, so that few lanes wait for contacts of others.
  std::sort(together.begin(), together.end(), [](const Constraints* a, const Constraints* b) {
    return a->contacts > b->contacts;
  });
  std::size_t alone = together.size() % static_cast<std::size_t>(lanes.width);
  if (alone >= worth_it) alone = 0;
  for (std::size_t i = 0; i < alone; ++i)
    iterate(*together[i], simulations[0]->velocity_iterations);
  if (lanes.iterate)
    lanes.iterate(together.data() + alone, static_cast<int>(together.size() - alone),
                  simulations[0]->velocity_iterations);
  for (int i = 0; i < count; ++i)
    attempt(simulations[i], [&](Simulation& simulation) {
      simulation.time_step.finish();
      simulation.sense();
    });
}

}  // namespace neol
