// The iterations of several worlds of a task at once, in the lanes of vectors; once for each kind
// of vector that the build can make (LANES in library.py). All of them give the bits of
// shortcut.hpp.
#pragma once

#include "constraints.hpp"

namespace neol {

// A body with more contacts is too rare to reserve space for it in each group of lanes.
constexpr int contact_slots = 6;

// A kind of vector.
struct Lanes {
  int width;  // how many worlds it holds
  void (*solve_velocities)(Constraints* const* islands, int count, int iterations);

  // Makes up to `iterations` position iterations and writes for each island how many remain: `left`
  // if its errors are still large, else 0. If an angle is too large for `sines`, nothing of the
  // island is changed or written. Null without sines.
  void (*solve_places)(Constraints* const* islands, int count, int iterations, int left,
                       int* iterations_left);

  // The sines and cosines of `count` angles, a multiple of the width, below `sines_end`: those of
  // one version of the C library.
  void (*sines)(const float* angles, float* sines, float* cosines, int count);
};
constexpr float sines_end = 120;

namespace vectors {
extern const Lanes sse2, avx2, avx512, neon;
}

}  // namespace neol
