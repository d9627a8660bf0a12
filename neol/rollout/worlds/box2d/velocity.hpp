// The velocity iterations of Box2D's solver, for one world (Real = float) or for several in
// lockstep (Real = a vector of floats, one lane for each world). Each operation is that of
// b2RevoluteJoint::SolveVelocityConstraints and b2ContactSolver::SolveVelocityConstraints, with the
// same operands in the same order, so each lane has Box2D's bits. Three things differ, none of
// which can change a bit: values that are the same in each iteration are computed once; the ground,
// which never moves, gets no impulses; where Box2D branches, both sides are computed and one is
// chosen.
//
// This file is compiled once for each kind of vector, so it includes nothing that other files
// include too: the linker keeps one copy of an inline function, and that must run on every machine.
#pragma once

#define NEOL_INLINE inline __attribute__((always_inline))

namespace neol {

// Result of comparing Reals: one word for each lane, with all bits set where the comparison holds.
template <class Real>
struct MaskOf {
  using Type = decltype(Real{} < Real{});
};
template <>
struct MaskOf<float> {
  using Type = int;
};
template <class Real>
using Mask = typename MaskOf<Real>::Type;

template <class Real>
struct Velocity {
  Real x, y, turn;
};

// The part of a hinge with a motor and limits that iterations only read.
template <class Real>
struct JointTerms {
  Real mass_a, inertia_a, mass_b, inertia_b;         // inverse
  Real arm_a_x, arm_a_y, arm_b_x, arm_b_y;           // from the centre of mass to the hinge
  Real minus_motor_mass, speed, weakest, strongest;  // of the motor; its impulse's range
  Real k11, k12, k13, k22, k23, k33;                 // effective mass, inverse; it is symmetric
  Real cross_x, cross_y, cross_z;                    // of its second and third column
  Real inverse_det2, inverse_det3;
  Mask<Real> at_lower, at_upper;  // limits
};

// The part that they change. `x` and `y`, the hinge's impulse, only add up: no iteration reads
// them.
template <class Real>
struct JointImpulse {
  Real motor, limit;
};
template <class Real>
struct HingeImpulse {
  Real x, y;
};

template <class Real>
struct PointTerms {
  Real arm_x, arm_y;        // from the body's centre of mass
  Real ground_x, ground_y;  // velocity of the ground there: zero, of either sign
  Real normal_mass, tangent_mass, bias;
};

// A contact of a body with the ground at one point or two. The effective mass of two, `k`, and its
// inverse `m` are symmetric.
template <class Real>
struct ContactTerms {
  Real normal_x, normal_y, friction, mass, inertia;
  Real k11, k12, k22, m11, m12, m22;
  PointTerms<Real> point[2];
  Mask<Real> used, two;
};

template <class Real>
struct ContactImpulse {
  Real normal[2], tangent[2];
};

template <class Real>
NEOL_INLINE Real clamp(Real value, Real low, Real high) {
  value = value < high ? value : high;
  return low > value ? low : value;
}

// a and not b. The mask of a scalar is a truth value, which ~ would not negate.
template <class Real>
NEOL_INLINE Mask<Real> and_not(Mask<Real> a, Mask<Real> b) {
  if constexpr (sizeof(Real) == sizeof(float))
    return a && !b;
  else
    return a & ~b;
}

// `limited`: whether the joint is at a limit in any lane.
template <class Real>
NEOL_INLINE void solve_joint(const JointTerms<Real>& joint, bool limited,
                             JointImpulse<Real>& impulse, HingeImpulse<Real>& hinge,
                             Velocity<Real>& a, Velocity<Real>& b) {
  {
    const Real rate = b.turn - a.turn - joint.speed;
    const Real total =
        clamp<Real>(impulse.motor + joint.minus_motor_mass * rate, joint.weakest, joint.strongest);
    const Real change = total - impulse.motor;
    impulse.motor = total;
    a.turn -= joint.inertia_a * change;
    b.turn += joint.inertia_b * change;
  }
  const Real rate_x = b.x - b.turn * joint.arm_b_y - a.x + a.turn * joint.arm_a_y;
  const Real rate_y = b.y + b.turn * joint.arm_b_x - a.y - a.turn * joint.arm_a_x;
  const Mask<Real> at_limit = joint.at_lower | joint.at_upper;
  Real to_x = -rate_x, to_y = -rate_y;
  if (limited) {  // the limit already pushes
    to_x = at_limit ? to_x + impulse.limit * joint.k13 : to_x;
    to_y = at_limit ? to_y + impulse.limit * joint.k23 : to_y;
  }
  Real x = joint.inverse_det2 * (joint.k22 * to_x - joint.k12 * to_y);
  Real y = joint.inverse_det2 * (joint.k11 * to_y - joint.k12 * to_x);
  if (!limited) {
    a.turn -= joint.inertia_a * (joint.arm_a_x * y - joint.arm_a_y * x);
    b.turn += joint.inertia_b * (joint.arm_b_x * y - joint.arm_b_y * x);
  } else {
    const Real rate_z = b.turn - a.turn;
    const Real x3 = -(joint.inverse_det3 *
                      (rate_x * joint.cross_x + rate_y * joint.cross_y + rate_z * joint.cross_z));
    const Real y3 = -(joint.inverse_det3 * (joint.k11 * (rate_y * joint.k33 - rate_z * joint.k23) +
                                            joint.k12 * (rate_z * joint.k13 - rate_x * joint.k33) +
                                            joint.k13 * (rate_x * joint.k23 - rate_y * joint.k13)));
    const Real z3 = -(joint.inverse_det3 * (joint.k11 * (joint.k22 * rate_z - joint.k23 * rate_y) +
                                            joint.k12 * (joint.k23 * rate_x - joint.k12 * rate_z) +
                                            joint.k13 * (joint.k12 * rate_y - joint.k22 * rate_x)));
    const Real total = impulse.limit + z3;
    const Mask<Real> leaves =
        (joint.at_lower & (total < Real{})) | (joint.at_upper & (total > Real{}));
    const Mask<Real> stays = and_not<Real>(at_limit, leaves);
    x = stays ? x3 : x;
    y = stays ? y3 : y;
    // Away from a limit there is no third term: to add -0 changes nothing, not even a zero's sign.
    const Real z = leaves ? -impulse.limit : stays ? z3 : -Real{};
    impulse.limit = leaves ? Real{} : stays ? total : impulse.limit;
    a.turn -= joint.inertia_a * (joint.arm_a_x * y - joint.arm_a_y * x + z);
    b.turn += joint.inertia_b * (joint.arm_b_x * y - joint.arm_b_y * x + z);
  }
  hinge.x += x;
  hinge.y += y;
  a.x -= joint.mass_a * x;
  a.y -= joint.mass_a * y;
  b.x += joint.mass_b * x;
  b.y += joint.mass_b * y;
}

// Velocity of a point of contact relative to the ground, along a direction.
template <class Real>
NEOL_INLINE Real rate_along(const PointTerms<Real>& point, const Velocity<Real>& body, Real x,
                            Real y) {
  return (body.x - body.turn * point.arm_y - point.ground_x) * x +
         (body.y + body.turn * point.arm_x - point.ground_y) * y;
}

template <class Real>
NEOL_INLINE Real torque(const PointTerms<Real>& point, Real x, Real y) {
  return point.arm_x * y - point.arm_y * x;
}

template <class Real>
NEOL_INLINE void solve_friction(const ContactTerms<Real>& contact, const PointTerms<Real>& point,
                                Real normal, Real& tangent, Velocity<Real>& body) {
  const Real along_x = contact.normal_y, along_y = -contact.normal_x;
  const Real most = contact.friction * normal;
  const Real total = clamp<Real>(
      tangent + point.tangent_mass * -rate_along(point, body, along_x, along_y), -most, most);
  const Real change = total - tangent;
  const Real x = change * along_x, y = change * along_y;
  tangent = total;
  body.x += contact.mass * x;
  body.y += contact.mass * y;
  body.turn += contact.inertia * torque(point, x, y);
}

// The block solver: the first that is valid of the four cases of which points push, or else none.
template <class Real>
NEOL_INLINE Mask<Real> solve_two_points(const ContactTerms<Real>& contact, Real rate1, Real rate2,
                                        const Real (&old)[2], Real& x, Real& y) {
  const Real zero{};
  const Real b1 = rate1 - contact.point[0].bias - (contact.k11 * old[0] + contact.k12 * old[1]);
  const Real b2 = rate2 - contact.point[1].bias - (contact.k12 * old[0] + contact.k22 * old[1]);
  x = -(contact.m11 * b1 + contact.m12 * b2);
  y = -(contact.m12 * b1 + contact.m22 * b2);
  const Mask<Real> both = (x >= zero) & (y >= zero);
  if constexpr (sizeof(Real) == sizeof(float))
    if (both) return both;
  const Real x_alone = -contact.point[0].normal_mass * b1;
  const Real y_alone = -contact.point[1].normal_mass * b2;
  const Mask<Real> first = (x_alone >= zero) & (contact.k12 * x_alone + b2 >= zero);
  const Mask<Real> second = (y_alone >= zero) & (contact.k12 * y_alone + b1 >= zero);
  const Mask<Real> neither = (b1 >= zero) & (b2 >= zero);
  x = both ? x : first ? x_alone : zero;
  y = both ? y : first ? zero : second ? y_alone : zero;
  return both | first | second | neither;
}

// `two`: whether the contact has two points in any lane.
template <class Real>
NEOL_INLINE void solve_contact(const ContactTerms<Real>& contact, bool two,
                               ContactImpulse<Real>& impulse, Velocity<Real>& velocity) {
  const PointTerms<Real>&first = contact.point[0], &second = contact.point[1];
  const Real normal_x = contact.normal_x, normal_y = contact.normal_y;
  Velocity<Real> body = velocity;
  solve_friction(contact, first, impulse.normal[0], impulse.tangent[0], body);
  if (two) {
    Velocity<Real> other = body;
    Real tangent = impulse.tangent[1];
    solve_friction(contact, second, impulse.normal[1], tangent, other);
    impulse.tangent[1] = contact.two ? tangent : impulse.tangent[1];
    body.x = contact.two ? other.x : body.x;
    body.y = contact.two ? other.y : body.y;
    body.turn = contact.two ? other.turn : body.turn;
  }
  const Real rate = rate_along(first, body, normal_x, normal_y);
  const Real raised = impulse.normal[0] + -first.normal_mass * (rate - first.bias);
  Real total = raised > Real{} ? raised : Real{};
  const Real change = total - impulse.normal[0];
  Real x = change * normal_x, y = change * normal_y, turn = torque(first, x, y);
  Mask<Real> used = contact.used;
  if (two) {
    Real total1, total2;
    const Mask<Real> solved =
        solve_two_points(contact, rate, rate_along(second, body, normal_x, normal_y),
                         impulse.normal, total1, total2);
    const Real change1 = total1 - impulse.normal[0], change2 = total2 - impulse.normal[1];
    const Real x1 = change1 * normal_x, y1 = change1 * normal_y;
    const Real x2 = change2 * normal_x, y2 = change2 * normal_y;
    x = contact.two ? x1 + x2 : x;
    y = contact.two ? y1 + y2 : y;
    turn = contact.two ? torque(first, x1, y1) + torque(second, x2, y2) : turn;
    total = contact.two ? (solved ? total1 : impulse.normal[0]) : total;
    impulse.normal[1] = contact.two & solved ? total2 : impulse.normal[1];
    const Mask<Real> unsolved = and_not<Real>(contact.two, solved);
    body.x = unsolved ? body.x : body.x + contact.mass * x;
    body.y = unsolved ? body.y : body.y + contact.mass * y;
    body.turn = unsolved ? body.turn : body.turn + contact.inertia * turn;
  } else {
    body.x += contact.mass * x;
    body.y += contact.mass * y;
    body.turn += contact.inertia * turn;
  }
  impulse.normal[0] = total;
  velocity.x = used ? body.x : velocity.x;
  velocity.y = used ? body.y : velocity.y;
  velocity.turn = used ? body.turn : velocity.turn;
}

}  // namespace neol
