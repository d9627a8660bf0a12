// The moving parts of a world as Box2D's solver sees them: read from the world, solved here, and
// written back. Nothing of the world changes before it is written, so where an island is out of
// the ordinary (asleep, too fast, not a number) Box2D's own solver can take the step instead.
//
// The tasks' worlds are simple: parts hang together by hinges in one island, and touch nothing but
// the ground, which stands still at the origin. So an impulse on the ground changes nothing, and
// the terms of the ground's mass, zero times something finite, are left out of sums.
#pragma once

#include <Box2D/Box2D.h>

#include <cstring>

#include "velocity.hpp"

namespace neol {

// What a contact's position iterations read. Of the two bodies one is the ground: what is given in
// its frame is computed once.
struct ContactPlace {
  bool face_is_ground;  // else it is the part's
  b2Vec2 normal, plane;  // of the face, in its body's frame
  b2Vec2 points[2];      // of the other body, in its frame
  int count;
  float ground_radius, part_radius;
};

// Where a part is. Its rotation is computed when the angle has changed.
struct Place {
  b2Vec2 centre;
  float angle;
  b2Rot rotation;
  bool stale;

  void turn_to(float changed) {
    const bool same = std::memcmp(&changed, &angle, sizeof angle) == 0;
    angle = changed;
    if (!same) stale = true;
  }
  const b2Rot& rotated() {
    if (stale) rotation.Set(angle);
    stale = false;
    return rotation;
  }
};

class Island : public Constraints {
 public:
  // The order of parts and joints in a new world's island.
  void attach(b2World* world);

  // Takes in a step's beginning: forces, warm starting, the terms of joints and contacts. Whether
  // the island is an ordinary one.
  bool read(const b2TimeStep& step);

  // The position iterations, after the velocity iterations.
  void move(const b2TimeStep& step);

  // Whether the results are numbers: then so were all impulses on the way to them, since each
  // was added to a velocity or position, and what is infinite or not a number stays so.
  bool is_finite() const;

  // Writes the results to the world, sends resting parts to sleep.
  void write(const b2TimeStep& step);

  b2Body* body[max_bodies];
  b2RevoluteJoint* joint[max_joints];
  int body_a[max_joints], body_b[max_joints];  // of a joint

 private:
  bool read_contact(const b2TimeStep& step, b2Contact* contact, int index);
  void read_joint(const b2TimeStep& step, int index);
  bool solve_contact_places();
  bool solve_joint_places();
  b2World* world_ = nullptr;
  b2Contact* contact_[max_contacts];
  b2LimitState limit_[max_joints];
  ContactPlace contact_place_[max_contacts];
  Place place_[max_bodies];
  b2Rot initial_rotation_[max_bodies];
  bool resolved_ = false;
};

}  // namespace neol
