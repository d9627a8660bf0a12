// The iterations of one world, those that only repeat left out. An iteration is a function of the
// numbers that it reads and changes; when these have come back, bit for bit, to what they once
// were, all that followed then will follow again, and only the remainder of the last round is left
// to do.
#pragma once

#include "constraints.hpp"

namespace neol {

// When to save a state with which later ones are compared (Brent's way to find a cycle): ever more
// seldom, so that a cycle of any length is met whole, however late it is entered.
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

// The impulses of hinges are not read by the velocity iterations, they only add up: these additions
// are made, each in its turn.
void solve_velocities(Constraints& island, int iterations);

// Position iterations, until errors are small.
void solve_places(Constraints& island, int iterations);

}  // namespace neol
