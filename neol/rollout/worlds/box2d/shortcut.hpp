// The iterations of one world, without those that only repeat. An iteration is a function of the
// numbers that it reads and changes. Once these return to earlier values, bit for bit, the
// iterations in between repeat, and only the remainder of the last cycle has to be computed.
#pragma once

#include "constraints.hpp"

namespace neol {

// When to save a state for comparison with later ones (Brent's cycle detection): at growing
// intervals, so that a cycle of any length is found, however late it begins.
class SavePoints {
 public:
  // Whether to save after `done` iterations.
  bool is_due(int done) {
    if (done < next_) return false;
    next_ = done + done / 2 + 1;
    return true;
  }

 private:
  int next_ = 1;
};

// The velocity iterations do not read the hinges' impulses, which only add up. These additions are
// made in their order for all iterations, also for those left out.
void solve_velocities(Constraints& island, int iterations);

// Position iterations, until errors are small.
void solve_places(Constraints& island, int iterations);

}  // namespace neol
