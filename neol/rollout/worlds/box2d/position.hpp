// The position iterations of Box2D's solver, for one world or several in lockstep, as in
// velocity.hpp: b2ContactSolver::SolvePositionConstraints and
// b2RevoluteJoint::SolvePositionConstraints. The caller passes `rotate`, which computes a place's
// sine and cosine from its angle.
#pragma once

#include "velocity.hpp"

namespace neol {

// Box2D's tolerances, in metres and radians. A length below `slop` has a square below
// `squared_slop`: the largest float with a square root, rounded, of at most 0.005.
constexpr float slop = 0.005f, squared_slop = 0x1.a36e3p-16f;
constexpr float angular_slop = 2.0f / 180.0f * 3.14159265359f;
constexpr float max_correction = 0.2f, max_angular_correction = 8.0f / 180.0f * 3.14159265359f;
constexpr float share_corrected = 0.2f, least_separation = -3.0f * slop;

// A body's centre of mass and rotation.
template <class Real>
struct Place {
  Real x, y, angle;
  Real turned, sine, cosine;  // an earlier angle, its sine and cosine
};

template <class Real>
struct BodyTerms {
  Real centre_x, centre_y;  // of mass, in the body's frame
  Real mass, inertia;       // inverse
};

template <class Real>
struct HingePlace {
  Real a_x, a_y, b_x, b_y;       // the hinge from the centres of mass, in the bodies' frames
  Real reference, lower, upper;  // angles
  Real minus_motor_mass;
  Mask<Real> at_lower, at_upper;
};

// Where a face of one body touches points of another; one of the two is the ground.
template <class Real>
struct ContactPlace {
  Real normal_x, normal_y, plane_x, plane_y;  // of the face, in its body's frame
  Real x[2], y[2];                            // points, in theirs
  Real ground_radius, part_radius;
  Mask<Real> face_is_ground, second;  // point
};

template <class Real>
NEOL_INLINE void keep(Mask<Real> changed, const Place<Real>& now, Place<Real>& place) {
  place.x = changed ? now.x : place.x;
  place.y = changed ? now.y : place.y;
  place.angle = changed ? now.angle : place.angle;
  place.turned = now.turned;
  place.sine = now.sine;
  place.cosine = now.cosine;
}

template <class Real>
struct Vector {
  Real x, y;
};

template <class Real>
NEOL_INLINE Vector<Real> rotated(const Place<Real>& place, Real x, Real y) {
  return {place.cosine * x - place.sine * y, place.sine * x + place.cosine * y};
}

// Returns whether the joint's errors were small. `limited`: whether it is at a limit in any lane.
// Lanes that are not `active` do not change.
template <class Real, class Rotate>
NEOL_INLINE Mask<Real> solve_hinge_place(const HingePlace<Real>& hinge,
                                         const BodyTerms<Real>& body_a,
                                         const BodyTerms<Real>& body_b, bool limited,
                                         Mask<Real> active, Place<Real>& place_a,
                                         Place<Real>& place_b, Rotate rotate) {
  const Real zero{};
  Place<Real> a = place_a, b = place_b;
  const Real mass_a = body_a.mass, mass_b = body_b.mass;
  const Real inertia_a = body_a.inertia, inertia_b = body_b.inertia;
  Real angular_error = zero;
  if (limited) {
    const Real angle = b.angle - a.angle - hinge.reference;
    const Real under = angle - hinge.lower, over = angle - hinge.upper;
    const Real correction =
        hinge.at_lower ? clamp<Real>(under + angular_slop, zero - max_angular_correction, zero)
                       : clamp<Real>(over - angular_slop, zero, zero + max_angular_correction);
    const Real impulse = hinge.minus_motor_mass * correction;
    const Mask<Real> at_limit = hinge.at_lower | hinge.at_upper;
    angular_error = hinge.at_lower ? -under : hinge.at_upper ? over : zero;
    a.angle = at_limit ? a.angle - inertia_a * impulse : a.angle;
    b.angle = at_limit ? b.angle + inertia_b * impulse : b.angle;
  }
  rotate(a);
  rotate(b);
  const Vector<Real> arm_a = rotated(a, hinge.a_x, hinge.a_y);
  const Vector<Real> arm_b = rotated(b, hinge.b_x, hinge.b_y);
  const Real gap_x = b.x + arm_b.x - a.x - arm_a.x;
  const Real gap_y = b.y + arm_b.y - a.y - arm_a.y;
  const Real k11 = mass_a + mass_b + inertia_a * arm_a.y * arm_a.y + inertia_b * arm_b.y * arm_b.y;
  const Real k12 = -inertia_a * arm_a.x * arm_a.y - inertia_b * arm_b.x * arm_b.y;
  const Real k22 = mass_a + mass_b + inertia_a * arm_a.x * arm_a.x + inertia_b * arm_b.x * arm_b.x;
  Real inverse = k11 * k22 - k12 * k12;
  inverse = inverse != zero ? 1.0f / inverse : inverse;
  const Real x = -(inverse * (k22 * gap_x - k12 * gap_y));
  const Real y = -(inverse * (k11 * gap_y - k12 * gap_x));
  a.x -= mass_a * x;
  a.y -= mass_a * y;
  a.angle -= inertia_a * (arm_a.x * y - arm_a.y * x);
  b.x += mass_b * x;
  b.y += mass_b * y;
  b.angle += inertia_b * (arm_b.x * y - arm_b.y * x);
  keep<Real>(active, a, place_a);
  keep<Real>(active, b, place_b);
  return (gap_x * gap_x + gap_y * gap_y <= zero + squared_slop) &
         (angular_error <= zero + angular_slop);
}

// `nearest`: the least separation so far.
template <class Real, class Rotate>
NEOL_INLINE void solve_contact_point(const ContactPlace<Real>& face, int index,
                                     const BodyTerms<Real>& body, Mask<Real> active, Real& nearest,
                                     Place<Real>& place, Rotate rotate) {
  const Real zero{};
  const Mask<Real> on_ground = face.face_is_ground;
  Place<Real> p = place;
  rotate(p);
  const Vector<Real> centre = rotated(p, body.centre_x, body.centre_y);
  const Real origin_x = p.x - centre.x, origin_y = p.y - centre.y;
  const Vector<Real> turned = rotated<Real>(p, on_ground ? face.x[index] : face.plane_x,
                                            on_ground ? face.y[index] : face.plane_y);
  const Vector<Real> normal = rotated(p, face.normal_x, face.normal_y);
  const Real there_x = turned.x + origin_x, there_y = turned.y + origin_y;
  const Real point_x = on_ground ? there_x : face.x[index];
  const Real point_y = on_ground ? there_y : face.y[index];
  const Real plane_x = on_ground ? face.plane_x : there_x;
  const Real plane_y = on_ground ? face.plane_y : there_y;
  Real normal_x = on_ground ? face.normal_x : normal.x;
  Real normal_y = on_ground ? face.normal_y : normal.y;
  const Real separation = ((point_x - plane_x) * normal_x + (point_y - plane_y) * normal_y) -
                          face.ground_radius - face.part_radius;
  normal_x = on_ground ? normal_x : -normal_x;
  normal_y = on_ground ? normal_y : -normal_y;
  const Real arm_x = point_x - p.x, arm_y = point_y - p.y;
  const Real error =
      clamp<Real>(share_corrected * (separation + slop), zero - max_correction, zero);
  const Real across = arm_x * normal_y - arm_y * normal_x;
  const Real k = body.mass + body.inertia * across * across;
  const Real impulse = k > zero ? -error / k : zero;
  const Real x = impulse * normal_x, y = impulse * normal_y;
  p.x += body.mass * x;
  p.y += body.mass * y;
  p.angle += body.inertia * (arm_x * y - arm_y * x);
  const Real nearer = nearest < separation ? nearest : separation;
  nearest = active ? nearer : nearest;
  keep<Real>(active, p, place);
}

}  // namespace neol
