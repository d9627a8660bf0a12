// The velocity iterations of several worlds of a task at once, in the lanes of vectors; once for
// each kind of vector that the build can make (LANES in library.py). All of them give the bits of
// `iterate` in shortcut.hpp.
#pragma once

#include "velocity.hpp"

namespace neol {

// A body with more contacts than this is too rare to have its place in each group of lanes.
constexpr int contact_slots = 6;

#define NEOL_DECLARE_LANES(kind)                                                      \
  namespace kind {                                                                    \
  extern const int width; /* how many worlds a vector holds */                        \
  void iterate(Constraints* const* islands, int count, int iterations);               \
  }

NEOL_DECLARE_LANES(sse2)
NEOL_DECLARE_LANES(avx2)
NEOL_DECLARE_LANES(avx512)
NEOL_DECLARE_LANES(neon)

}  // namespace neol
