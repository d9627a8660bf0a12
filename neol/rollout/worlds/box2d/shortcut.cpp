#include "shortcut.hpp"

#include <cstddef>
#include <cstring>
#include <vector>

namespace neol {

namespace {

template <class Parts>
void iterate_parts(Constraints& island, int iterations) {
  Constraints::State& state = island.state;
  const auto iterate_once = [&](HingeImpulse<float>* changes) {
    for (int i = 0; i < Parts::joints; ++i) {
      const JointTerms<float>& joint = island.joint_terms[i];
      changes[i] = {-0.0f, -0.0f};  // to which x is added as x, -0 too
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

}  // namespace

void iterate(Constraints& island, int iterations) {
  if (island.joints == LunarLanderParts::joints)
    iterate_parts<LunarLanderParts>(island, iterations);
  else
    iterate_parts<BipedalWalkerParts>(island, iterations);
}

}  // namespace neol
