// One environment step's physics in many simulations of a task at once. Box2D's own step, of one
// world after the other, is the path `plain`; each other one gives the same bits in less time.
#pragma once

#include "simulation.hpp"

namespace neol {

enum class Path { plain, shortcut, sse2, avx2, avx512, neon };

// Whether this processor and this build have it.
bool available(Path path);

// The fastest.
Path best_path();

// What Simulation::advance does now in each simulation with its action, bit for bit. Where Box2D
// fails an assertion, that simulation is marked as failed, and the others go on.
void advance_all(Path path, Simulation* const* simulations, const float* const* actions, int count);

}  // namespace neol
