// One environment step's physics in many simulations of a task at once. Box2D's own step, in one
// world after the other, is the path `plain`; each other path gives the same bits in less time.
#pragma once

#include "lanes.hpp"
#include "simulation.hpp"

namespace neol {

// `shortcut` solves one world after the other, the paths after it many at once in a vector's lanes.
enum class Path { plain, shortcut, sse2, avx2, avx512, neon };

// Whether this processor and this build have a path.
bool available(Path path);

// The fastest of the available paths.
Path best_path();

// The vectors of a path that is available; null where it has none.
const Lanes* lanes_of(Path path);

// Whether the path has sines that are the C library's here.
bool has_exact_sines(Path path);

// What Simulation::advance does now in each simulation with its action, bit for bit. Where Box2D
// fails an assertion, that simulation is marked as failed, and the others go on.
void advance_all(Path path, Simulation* const* simulations, const float* const* actions, int count);

}  // namespace neol
