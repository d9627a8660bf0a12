// State of one island that the solver's iterations read and change.
#pragma once

#include "position.hpp"
#include "velocity.hpp"

namespace neol {

// The order of bodies and joints in an island: Box2D's, which follows from how they were created.
// Joint i turns body_b[i] against body_a[i].
struct LunarLanderParts {
  static constexpr int bodies = 3, joints = 2;  // leg, lander, leg
  static constexpr int body_a[] = {1, 1}, body_b[] = {0, 2};
};
struct BipedalWalkerParts {
  static constexpr int bodies = 5, joints = 4;  // lower leg, upper leg, hull, upper leg, lower leg
  static constexpr int body_a[] = {1, 2, 2, 3}, body_b[] = {0, 1, 3, 4};
};

// The largest island: no task has more bodies or joints, and a step with more contacts is left to
// Box2D.
constexpr int max_bodies = 5, max_joints = 4, max_contacts = 24;

// One whole island. Contacts are in the order of their bodies.
struct Constraints {
  // What iterations read and change: equal states have equal continuations.
  struct State {
    Velocity<float> velocity[max_bodies];
    JointImpulse<float> joint[max_joints];
    ContactImpulse<float> contact[max_contacts];
  };
  State state;
  HingeImpulse<float> hinge[max_joints];
  JointTerms<float> joint_terms[max_joints];
  ContactTerms<float> contact_terms[max_contacts];
  int contact_body[max_contacts];

  Place<float> place[max_bodies];
  BodyTerms<float> body_terms[max_bodies];
  HingePlace<float> hinge_place[max_joints];
  ContactPlace<float> contact_place[max_contacts];
  bool resolved;  // the position iterations ended with errors small enough

  int bodies = 0, joints = 0, contacts = 0;
  int body_a[max_joints], body_b[max_joints];  // of a joint
};

}  // namespace neol
