#include "shortcut.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

namespace neol {

namespace {

template <class Parts>
void solve_velocities_of(Constraints& island, int iterations) {
  Constraints::State& state = island.state;
  const auto iterate_once = [&](HingeImpulse<float>* changes) {
    for (int i = 0; i < Parts::joints; ++i) {
      const JointTerms<float>& joint = island.joint_terms[i];
      changes[i] = {-0.0f, -0.0f};  // adding x to it gives x, also for x = -0
      solve_joint(joint, joint.at_lower | joint.at_upper, state.joint[i], changes[i],
                  state.velocity[Parts::body_a[i]], state.velocity[Parts::body_b[i]]);
    }
    for (int i = 0; i < island.contacts; ++i)
      solve_contact(island.contact_terms[i], island.contact_terms[i].two, state.contact[i],
                    state.velocity[island.contact_body[i]]);
  };
  const auto add_up = [&](const HingeImpulse<float>* changes) {
    for (int i = 0; i < Parts::joints; ++i) {
      island.hinge[i].x += changes[i].x;
      island.hinge[i].y += changes[i].y;
    }
  };
  const std::size_t size = offsetof(Constraints::State, contact) +
                           static_cast<std::size_t>(island.contacts) * sizeof state.contact[0];

  std::vector<HingeImpulse<float>> changes(static_cast<std::size_t>(iterations * Parts::joints));
  Constraints::State saved;
  std::memcpy(&saved, &state, size);
  int saved_at = 0;
  SavePoints save_points;
  for (int done = 1; done <= iterations; ++done) {
    HingeImpulse<float>* now = &changes[static_cast<std::size_t>((done - 1) * Parts::joints)];
    iterate_once(now);
    add_up(now);
    if (std::memcmp(&state, &saved, size) == 0) {
      int rest = iterations - done;
      const int cycle = done - saved_at;
      for (; rest >= cycle; rest -= cycle)
        for (int i = saved_at; i < done; ++i)
          add_up(&changes[static_cast<std::size_t>(i * Parts::joints)]);
      for (; rest > 0; --rest) {
        iterate_once(now);
        add_up(now);
      }
      return;
    }
    if (save_points.is_due(done)) {
      std::memcpy(&saved, &state, size);
      saved_at = done;
    }
  }
}

// Sines are computed where the angle has changed.
void rotate(Place<float>& place) {
  if (std::memcmp(&place.turned, &place.angle, sizeof place.angle) == 0) return;
  place.turned = place.angle;
  place.sine = std::sin(place.angle);
  place.cosine = std::cos(place.angle);
}

bool iterate_places(Constraints& island) {
  constexpr int active = -1;
  float nearest = 0;
  for (int i = 0; i < island.contacts; ++i) {
    const int body = island.contact_body[i];
    const ContactPlace<float>& contact = island.contact_place[i];
    for (int j = 0; j < (contact.second ? 2 : 1); ++j)
      solve_contact_point(contact, j, island.body_terms[body], active, nearest, island.place[body],
                          rotate);
  }
  bool resolved = nearest >= least_separation;
  for (int i = 0; i < island.joints; ++i) {
    const int a = island.body_a[i], b = island.body_b[i];
    const HingePlace<float>& hinge = island.hinge_place[i];
    resolved &= 0 != solve_hinge_place(hinge, island.body_terms[a], island.body_terms[b],
                                       hinge.at_lower | hinge.at_upper, active, island.place[a],
                                       island.place[b], rotate);
  }
  return resolved;
}

}  // namespace

void solve_velocities(Constraints& island, int iterations) {
  if (island.joints == LunarLanderParts::joints)
    solve_velocities_of<LunarLanderParts>(island, iterations);
  else
    solve_velocities_of<BipedalWalkerParts>(island, iterations);
}

void solve_places(Constraints& island, int iterations) {
  const auto is_same = [](const Place<float>& a, const Place<float>& b) {
    return std::memcmp(&a, &b, offsetof(Place<float>, turned)) == 0;
  };
  Place<float> saved[max_bodies];
  int saved_at = 0;
  SavePoints save_points;
  island.resolved = false;
  for (int done = 1; done <= iterations && !island.resolved; ++done) {
    island.resolved = iterate_places(island);
    if (saved_at > 0 && std::equal(saved, saved + island.bodies, island.place, is_same)) {
      for (int rest = (iterations - done) % (done - saved_at); rest > 0; --rest)
        iterate_places(island);
      break;
    }
    if (save_points.is_due(done)) {
      std::copy(island.place, island.place + island.bodies, saved);
      saved_at = done;
    }
  }
  std::for_each(island.place, island.place + island.bodies, rotate);
}

}  // namespace neol
