#include "lockstep.hpp"

namespace neol {

bool available(Path path) { return path == Path::plain || path == Path::shortcut; }

Path best_path() { return Path::shortcut; }

namespace {

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

}  // namespace

void advance_all(Path path, Simulation* const* simulations, const float* const* actions,
                 int count) {
  for (int i = 0; i < count; ++i)
    attempt(simulations[i], [&](Simulation& simulation) {
      if (path == Path::plain) return simulation.advance(actions[i]);
      simulation.act(actions[i]);
      TimeStep& step = simulation.time_step;
      if (step.begin(simulation.seconds, simulation.velocity_iterations,
                     simulation.position_iterations))
        iterate(step.island, simulation.velocity_iterations);
      step.finish();
      simulation.sense();
    });
}

}  // namespace neol
