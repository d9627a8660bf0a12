// Iterations that have begun to repeat are not made.
#pragma once

#include "velocity.hpp"

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

// The velocity iterations of one world, until they repeat: the state of all that they read has then
// come back, bit for bit, so what they did since will recur. Only the impulses of hinges go on
// adding up, and those additions are made, each in its turn.
void iterate(Constraints& island, int iterations);

}  // namespace neol
