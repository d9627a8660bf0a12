#include "island.hpp"

#include <algorithm>
#include <cmath>

namespace neol {

namespace {

// Far below the values that overflow when squared twice, far above any coordinate in the tasks.
constexpr float too_far = 1e6f, too_fast = 1e6f;

bool is_below(float value, float limit) { return std::abs(value) < limit; }  // false for NaN

b2Transform transform(const b2Vec2& centre, const b2Rot& rotation, const b2Vec2& local_centre) {
  return {centre - b2Mul(rotation, local_centre), rotation};
}

}  // namespace

// The depth-first search of b2World::Solve. Contacts do not matter: they lead to the ground, where
// the search ends.
void Island::attach(b2World* world) {
  world_ = world;
  bodies = joints = 0;
  b2Body* stack[max_bodies];
  int waiting = 0;
  b2Body* found[max_bodies];
  int count = 0;
  const auto find = [&](b2Body* part) {
    for (int i = 0; i < count; ++i)
      if (found[i] == part) return;
    found[count++] = stack[waiting++] = part;
  };
  find(world->GetBodyList());
  while (waiting > 0) {
    b2Body* part = body[bodies++] = stack[--waiting];
    for (b2JointEdge* edge = part->GetJointList(); edge; edge = edge->next) {
      bool known = false;
      for (int i = 0; i < joints; ++i) known |= joint[i] == edge->joint;
      if (known) continue;
      joint[joints++] = static_cast<b2RevoluteJoint*>(edge->joint);
      find(edge->other);
    }
  }
  const auto index_of = [&](const b2Body* part) {
    return static_cast<int>(std::find(body, body + bodies, part) - body);
  };
  for (int i = 0; i < joints; ++i) {
    body_a[i] = index_of(joint[i]->m_bodyA);
    body_b[i] = index_of(joint[i]->m_bodyB);
  }
}

bool Island::read(const b2TimeStep& step) {
  const float h = step.dt;
  for (int i = 0; i < bodies; ++i) {
    const b2Body& part = *body[i];
    b2Vec2 v = part.m_linearVelocity;
    float w = part.m_angularVelocity;
    v += h * (part.m_gravityScale * world_->m_gravity + part.m_invMass * part.m_force);
    w += h * part.m_invI * part.m_torque;
    v *= b2Clamp(1.0f - h * part.m_linearDamping, 0.0f, 1.0f);
    w *= b2Clamp(1.0f - h * part.m_angularDamping, 0.0f, 1.0f);
    state.velocity[i] = {v.x, v.y, w};
    initial_rotation_[i] = part.m_xf.q;
    const b2Vec2 &centre = part.m_sweep.c, &local_centre = part.m_sweep.localCenter;
    const float angle = part.m_sweep.a;
    place[i] = {centre.x, centre.y, angle, angle, part.m_xf.q.s, part.m_xf.q.c};
    body_terms[i] = {local_centre.x, local_centre.y, part.m_invMass, part.m_invI};
    if (!part.IsAwake() || !is_below(centre.x, too_far) || !is_below(centre.y, too_far) ||
        !is_below(angle, too_far) || !is_below(v.x, too_fast) || !is_below(v.y, too_fast) ||
        !is_below(w, too_fast))
      return false;
  }

  contacts = 0;
  for (int i = 0; i < bodies; ++i)
    for (b2ContactEdge* edge = body[i]->GetContactList(); edge; edge = edge->next) {
      if (!edge->contact->IsEnabled() || !edge->contact->IsTouching()) continue;
      if (contacts == max_contacts || !read_contact(step, edge->contact, i)) return false;
      ++contacts;
    }
  for (int i = 0; i < contacts; ++i) {  // warm starting
    const ContactTerms<float>& terms = contact_terms[i];
    Velocity<float>& velocity = state.velocity[contact_body[i]];
    const b2Vec2 normal(terms.normal_x, terms.normal_y), along = b2Cross(normal, 1.0f);
    for (int j = 0; j < (terms.two ? 2 : 1); ++j) {
      const b2Vec2 push = state.contact[i].normal[j] * normal + state.contact[i].tangent[j] * along;
      velocity.turn += terms.inertia * torque(terms.point[j], push.x, push.y);
      velocity.x += terms.mass * push.x;
      velocity.y += terms.mass * push.y;
    }
  }
  for (int i = 0; i < joints; ++i) {
    if (b2Abs(joint[i]->m_upperAngle - joint[i]->m_lowerAngle) < 2.0f * b2_angularSlop)
      return false;
    read_joint(step, i);
  }
  return true;
}

// b2ContactSolver's constructor and InitializeVelocityConstraints.
bool Island::read_contact(const b2TimeStep& step, b2Contact* contact, int index) {
  const b2Fixture* ground = contact->GetFixtureA();
  const b2Fixture* fixture = contact->GetFixtureB();
  const b2Body& part = *body[index];
  const b2Manifold& manifold = contact->m_manifold;
  if (ground->GetBody()->GetType() != b2_staticBody || fixture->GetBody() != &part ||
      manifold.type == b2Manifold::e_circles || contact->m_tangentSpeed != 0)
    return false;

  contact_[contacts] = contact;
  contact_body[contacts] = index;
  ContactTerms<float>& terms = contact_terms[contacts];
  ContactPlace<float>& face = contact_place[contacts];
  ContactImpulse<float>& impulse = state.contact[contacts];
  const Velocity<float>& velocity = state.velocity[index];

  b2Transform origin;
  origin.SetIdentity();
  const b2Vec2 centre = part.m_sweep.c;
  const b2Transform pose = transform(centre, initial_rotation_[index], part.m_sweep.localCenter);
  face.ground_radius = ground->GetShape()->m_radius;
  face.part_radius = fixture->GetShape()->m_radius;
  b2WorldManifold manifold_there;
  manifold_there.Initialize(&manifold, origin, face.ground_radius, pose, face.part_radius);

  const b2Vec2 normal = manifold_there.normal, along = b2Cross(normal, 1.0f);
  terms = {};
  terms.normal_x = normal.x;
  terms.normal_y = normal.y;
  terms.friction = contact->m_friction;
  terms.mass = part.m_invMass;
  terms.inertia = part.m_invI;
  terms.used = -1;
  const int count = manifold.pointCount;
  float across[2];
  for (int j = 0; j < count; ++j) {
    PointTerms<float>& point = terms.point[j];
    impulse.normal[j] = step.dtRatio * manifold.points[j].normalImpulse;
    impulse.tangent[j] = step.dtRatio * manifold.points[j].tangentImpulse;
    const b2Vec2 arm = manifold_there.points[j] - centre;
    const b2Vec2 ground_rate = b2Cross(0.0f, manifold_there.points[j]);
    point.arm_x = arm.x;
    point.arm_y = arm.y;
    point.ground_x = ground_rate.x;
    point.ground_y = ground_rate.y;
    across[j] = b2Cross(arm, normal);
    const float sideways = b2Cross(arm, along);
    const float normal_k = terms.mass + terms.inertia * across[j] * across[j];
    const float tangent_k = terms.mass + terms.inertia * sideways * sideways;
    point.normal_mass = normal_k > 0.0f ? 1.0f / normal_k : 0.0f;
    point.tangent_mass = tangent_k > 0.0f ? 1.0f / tangent_k : 0.0f;
    const b2Vec2 rate = b2Vec2(velocity.x, velocity.y) + b2Cross(velocity.turn, arm) - ground_rate;
    const float approach = b2Dot(normal, rate);
    if (approach < -b2_velocityThreshold) point.bias = -contact->m_restitution * approach;
  }
  if (count == 2) {
    const float k11 = terms.mass + terms.inertia * across[0] * across[0];
    const float k22 = terms.mass + terms.inertia * across[1] * across[1];
    const float k12 = terms.mass + terms.inertia * across[0] * across[1];
    constexpr float worst_condition = 1000.0f;
    if (k11 * k11 < worst_condition * (k11 * k22 - k12 * k12)) {
      const b2Mat22 k(b2Vec2(k11, k12), b2Vec2(k12, k22));
      const b2Mat22 m = k.GetInverse();
      terms.k11 = k11, terms.k12 = k12, terms.k22 = k22;
      terms.m11 = m.ex.x, terms.m12 = m.ex.y, terms.m22 = m.ey.y;
      terms.two = -1;
    }
  }
  if (!terms.two) impulse.normal[1] = impulse.tangent[1] = 0;

  // The ground's face and points, given in its frame, are moved to the world's frame.
  const bool on_ground = manifold.type == b2Manifold::e_faceA;
  face.face_is_ground = -on_ground;
  face.second = -(count == 2);
  b2Vec2 face_normal = manifold.localNormal, plane = manifold.localPoint;
  if (on_ground) {
    face_normal = b2Mul(origin.q, face_normal);
    plane = b2Mul(origin, plane);
  }
  face.normal_x = face_normal.x, face.normal_y = face_normal.y;
  face.plane_x = plane.x, face.plane_y = plane.y;
  for (int j = 0; j < 2; ++j) {
    b2Vec2 point = j < count ? manifold.points[j].localPoint : b2Vec2(0, 0);
    if (!on_ground) point = b2Mul(origin, point);
    face.x[j] = point.x, face.y[j] = point.y;
  }
  return true;
}

// b2RevoluteJoint::InitVelocityConstraints.
void Island::read_joint(const b2TimeStep& step, int index) {
  const b2RevoluteJoint& hinge_joint = *joint[index];
  const int a = body_a[index], b = body_b[index];
  const b2Vec2 local_a = hinge_joint.m_localAnchorA - hinge_joint.m_bodyA->m_sweep.localCenter;
  const b2Vec2 local_b = hinge_joint.m_localAnchorB - hinge_joint.m_bodyB->m_sweep.localCenter;
  const b2Vec2 arm_a = b2Mul(initial_rotation_[a], local_a);
  const b2Vec2 arm_b = b2Mul(initial_rotation_[b], local_b);
  const float mass_a = hinge_joint.m_bodyA->m_invMass, mass_b = hinge_joint.m_bodyB->m_invMass;
  const float inertia_a = hinge_joint.m_bodyA->m_invI, inertia_b = hinge_joint.m_bodyB->m_invI;

  b2Mat33 k;
  k.ex.x = mass_a + mass_b + arm_a.y * arm_a.y * inertia_a + arm_b.y * arm_b.y * inertia_b;
  k.ey.x = -arm_a.y * arm_a.x * inertia_a - arm_b.y * arm_b.x * inertia_b;
  k.ez.x = -arm_a.y * inertia_a - arm_b.y * inertia_b;
  k.ex.y = k.ey.x;
  k.ey.y = mass_a + mass_b + arm_a.x * arm_a.x * inertia_a + arm_b.x * arm_b.x * inertia_b;
  k.ez.y = arm_a.x * inertia_a + arm_b.x * inertia_b;
  k.ex.z = k.ez.x;
  k.ey.z = k.ez.y;
  k.ez.z = inertia_a + inertia_b;
  float motor_mass = inertia_a + inertia_b;
  if (motor_mass > 0.0f) motor_mass = 1.0f / motor_mass;

  float limit_impulse = hinge_joint.m_impulse.z;
  const float angle = place[b].angle - place[a].angle - hinge_joint.m_referenceAngle;
  const b2LimitState before = hinge_joint.m_limitState;
  b2LimitState& limit = limit_[index];
  limit = angle <= hinge_joint.m_lowerAngle   ? e_atLowerLimit
          : angle >= hinge_joint.m_upperAngle ? e_atUpperLimit
                                              : e_inactiveLimit;
  if (limit == e_inactiveLimit || limit != before) limit_impulse = 0.0f;

  const float x = hinge_joint.m_impulse.x * step.dtRatio;
  const float y = hinge_joint.m_impulse.y * step.dtRatio;
  const float z = limit_impulse * step.dtRatio;
  const float motor = hinge_joint.m_motorImpulse * step.dtRatio;
  const float strongest = step.dt * hinge_joint.m_maxMotorTorque;
  hinge[index] = {x, y};
  state.joint[index] = {motor, z};
  Velocity<float>&va = state.velocity[a], &vb = state.velocity[b];
  va.x -= mass_a * x;
  va.y -= mass_a * y;
  va.turn -= inertia_a * (b2Cross(arm_a, b2Vec2(x, y)) + motor + z);
  vb.x += mass_b * x;
  vb.y += mass_b * y;
  vb.turn += inertia_b * (b2Cross(arm_b, b2Vec2(x, y)) + motor + z);

  const b2Vec3 cross = b2Cross(k.ey, k.ez);
  float det2 = k.ex.x * k.ey.y - k.ey.x * k.ex.y, det3 = b2Dot(k.ex, cross);
  if (det2 != 0.0f) det2 = 1.0f / det2;
  if (det3 != 0.0f) det3 = 1.0f / det3;
  JointTerms<float>& terms = joint_terms[index];
  terms.mass_a = mass_a, terms.inertia_a = inertia_a;
  terms.mass_b = mass_b, terms.inertia_b = inertia_b;
  terms.arm_a_x = arm_a.x, terms.arm_a_y = arm_a.y;
  terms.arm_b_x = arm_b.x, terms.arm_b_y = arm_b.y;
  terms.minus_motor_mass = -motor_mass, terms.speed = hinge_joint.m_motorSpeed;
  terms.weakest = -strongest, terms.strongest = strongest;
  terms.k11 = k.ex.x, terms.k12 = k.ey.x, terms.k13 = k.ez.x;
  terms.k22 = k.ey.y, terms.k23 = k.ez.y, terms.k33 = k.ez.z;
  terms.cross_x = cross.x, terms.cross_y = cross.y, terms.cross_z = cross.z;
  terms.inverse_det2 = det2, terms.inverse_det3 = det3;
  terms.at_lower = -(limit == e_atLowerLimit);
  terms.at_upper = -(limit == e_atUpperLimit);
  hinge_place[index] = {local_a.x,
                        local_a.y,
                        local_b.x,
                        local_b.y,
                        hinge_joint.m_referenceAngle,
                        hinge_joint.m_lowerAngle,
                        hinge_joint.m_upperAngle,
                        -motor_mass,
                        terms.at_lower,
                        terms.at_upper};
}

void Island::integrate(const b2TimeStep& step) {
  const float h = step.dt;
  for (int i = 0; i < bodies; ++i) {
    Velocity<float>& velocity = state.velocity[i];
    b2Vec2 v(velocity.x, velocity.y);
    float w = velocity.turn;
    const b2Vec2 translation = h * v;
    if (b2Dot(translation, translation) > b2_maxTranslationSquared)
      v *= b2_maxTranslation / translation.Length();
    const float rotation = h * w;
    if (rotation * rotation > b2_maxRotationSquared) w *= b2_maxRotation / b2Abs(rotation);
    place[i].x += h * v.x;
    place[i].y += h * v.y;
    place[i].angle += h * w;
    velocity = {v.x, v.y, w};
  }
}

bool Island::is_finite() const {
  bool finite = true;
  for (int i = 0; i < bodies; ++i) {
    const Velocity<float>& velocity = state.velocity[i];
    finite &= std::isfinite(velocity.x) && std::isfinite(velocity.y) &&
              std::isfinite(velocity.turn) && std::isfinite(place[i].x) &&
              std::isfinite(place[i].y) && std::isfinite(place[i].angle);
  }
  return finite;
}

void Island::write(const b2TimeStep& step) {
  for (int i = 0; i < joints; ++i) {
    joint[i]->m_impulse = {hinge[i].x, hinge[i].y, state.joint[i].limit};
    joint[i]->m_motorImpulse = state.joint[i].motor;
    joint[i]->m_limitState = limit_[i];
  }
  for (int i = 0; i < contacts; ++i)
    for (int j = 0; j < (contact_terms[i].two ? 2 : 1); ++j) {
      contact_[i]->m_manifold.points[j].normalImpulse = state.contact[i].normal[j];
      contact_[i]->m_manifold.points[j].tangentImpulse = state.contact[i].tangent[j];
    }
  float resting = b2_maxFloat;  // time that all parts have rested
  for (int i = 0; i < bodies; ++i) {
    b2Body& part = *body[i];
    part.m_sweep.c0 = part.m_sweep.c;
    part.m_sweep.a0 = part.m_sweep.a;
    part.m_sweep.c = {place[i].x, place[i].y};
    part.m_sweep.a = place[i].angle;
    b2Rot rotation;
    rotation.s = place[i].sine;
    rotation.c = place[i].cosine;
    part.m_xf = transform(part.m_sweep.c, rotation, part.m_sweep.localCenter);
    const Velocity<float>& velocity = state.velocity[i];
    part.m_linearVelocity = {velocity.x, velocity.y};
    part.m_angularVelocity = velocity.turn;
    const b2Vec2& v = part.m_linearVelocity;
    if (velocity.turn * velocity.turn > b2_angularSleepTolerance * b2_angularSleepTolerance ||
        b2Dot(v, v) > b2_linearSleepTolerance * b2_linearSleepTolerance)
      part.m_sleepTime = 0.0f;
    else
      part.m_sleepTime += step.dt;
    resting = b2Min(resting, part.m_sleepTime);
  }
  if (resting >= b2_timeToSleep && resolved)
    for (int i = 0; i < bodies; ++i) body[i]->SetAwake(false);
}

}  // namespace neol
