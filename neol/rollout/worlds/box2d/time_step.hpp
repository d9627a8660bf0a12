// A world's time step, b2World::Step, in parts, between which the solver's iterations are made. It
// differs from Box2D's in three ways that change no bit: the island's solver is ours (island.hpp),
// the two hundred bodies of the ground are not visited, and iterations that only repeat are not
// made.
//
// All of this needs the private members of Box2D's classes, so the core is compiled without access
// control (FLAGS in library.py).
#pragma once

#include "island.hpp"

namespace neol {

class TimeStep {
 public:
  // A new world: its moving parts come first in the list of its bodies, then the ground.
  void attach(b2World* world);

  // The step up to the velocity iterations. Returns whether `island` makes these and the rest; if
  // not, `finish` leaves the solving to Box2D.
  bool begin(float seconds, int velocity_iterations, int position_iterations);

  // The step from the velocity iterations to the position iterations.
  void integrate() { island.integrate(step_); }

  void finish();

  // The whole step, in this world alone.
  void take(float seconds, int velocity_iterations, int position_iterations);

  // To be called after Box2D itself has taken a step, which leaves times of impact with the ground.
  void note_plain_step() { ground_is_reset_ = false; }

  Island island;

 private:
  void find_first_contacts();
  void synchronize_fixtures();
  void solve_impacts();
  bool update_impact(b2Contact* contact);
  void solve_impact(b2Contact* contact, float fraction);

  b2World* world_ = nullptr;
  b2TimeStep step_;
  bool ordinary_ = false;
  bool ground_is_reset_ = false;
};

}  // namespace neol
