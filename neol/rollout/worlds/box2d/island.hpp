// The moving parts of a world as Box2D's solver sees them: read from the world, solved here, and
// written back. Nothing of the world changes before it is written, so where an island is out of
// the ordinary (asleep, too fast, not a number) Box2D's own solver can take the step instead.
//
// The tasks' worlds are simple: parts hang together by hinges in one island, and touch nothing but
// the ground, which stands still at the origin. So an impulse on the ground changes nothing, and
// the terms of the ground's mass, zero times something finite, are left out of sums.
#pragma once

#include <Box2D/Box2D.h>

#include "constraints.hpp"

namespace neol {

class Island : public Constraints {
 public:
  // The order of parts and joints in a new world's island.
  void attach(b2World* world);

  // Takes in a step's beginning: forces, warm starting, the terms of joints and contacts. Whether
  // the island is an ordinary one.
  bool read(const b2TimeStep& step);

  // After the velocity iterations and before the position iterations.
  void integrate(const b2TimeStep& step);

  // Whether the results are numbers: then so were all impulses on the way to them, since each
  // was added to a velocity or position, and what is infinite or not a number stays so.
  bool is_finite() const;

  // Writes the results to the world, sends resting parts to sleep.
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
