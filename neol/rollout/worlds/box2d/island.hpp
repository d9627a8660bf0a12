// The moving parts of a world as Box2D's solver sees them: read from the world, solved here, and
// written back. The world does not change before the results are written, so Box2D's own solver can
// take the step of an unusual island (asleep, too fast, not a number) instead.
// The tasks' worlds are simple: hinges connect all parts to one island, which touches only the
// ground, and the ground does not move. So an impulse on the ground changes nothing, and the terms
// with the ground's inverse mass, zero times a finite number, are left out of sums.
#pragma once

#include <Box2D/Box2D.h>

#include "constraints.hpp"

namespace neol {

class Island : public Constraints {
 public:
  // The order of parts and joints in a new world's island.
  void attach(b2World* world);

  // Begins a step: forces, warm starting, the terms of joints and contacts. Returns whether the
  // island is an ordinary one, which can be solved here.
  bool read(const b2TimeStep& step);

  // Moves the parts, after the velocity iterations and before the position iterations.
  void integrate(const b2TimeStep& step);

  // Whether the results are finite. Then all impulses were, because each was added to a velocity or
  // a position, where an infinity or NaN remains.
  bool is_finite() const;

  // Writes the results to the world and puts resting parts to sleep.
  void write(const b2TimeStep& step);

  b2Body* body[max_bodies];
  b2RevoluteJoint* joint[max_joints];

 private:
  bool read_contact(const b2TimeStep& step, b2Contact* contact, int index);
  void read_joint(const b2TimeStep& step, int index);

  b2World* world_ = nullptr;
  b2Contact* contact_[max_contacts];
  b2LimitState limit_[max_joints];
  b2Rot initial_rotation_[max_bodies];
};

}  // namespace neol
