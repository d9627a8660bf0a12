// Compiled once for each kind of vector, named by NEOL_LANES; without it this file is empty.
#include "lanes.hpp"

#ifdef NEOL_LANES

#ifdef __FMA__
#include <immintrin.h>
#endif

#if defined(__AVX512F__)
#define NEOL_WIDTH 16
#elif defined(__AVX2__)
#define NEOL_WIDTH 8
#else
#define NEOL_WIDTH 4
#endif

namespace neol {

namespace {

constexpr int width = NEOL_WIDTH;

typedef float Real __attribute__((vector_size(4 * NEOL_WIDTH)));
typedef int Word __attribute__((may_alias));  // a float or a mask

// Structs of words become structs of vectors: lane by lane, word by word.
template <template <class> class Struct>
NEOL_INLINE void put(const Struct<float>& one, Struct<Real>& lanes, int lane) {
  static_assert(sizeof lanes == sizeof one * width);
  const Word* from = reinterpret_cast<const Word*>(&one);
  Word* to = reinterpret_cast<Word*>(&lanes) + lane;
  for (unsigned i = 0; i < sizeof one / sizeof(Word); ++i) to[i * width] = from[i];
}

template <template <class> class Struct>
NEOL_INLINE void get(Struct<float>& one, const Struct<Real>& lanes, int lane) {
  const Word* from = reinterpret_cast<const Word*>(&lanes) + lane;
  Word* to = reinterpret_cast<Word*>(&one);
  for (unsigned i = 0; i < sizeof one / sizeof(Word); ++i) to[i] = from[i * width];
}

template <template <class> class Struct>
NEOL_INLINE void clear(Struct<Real>& lanes) {
  __builtin_memset(&lanes, 0, sizeof lanes);
}

// Calls visit(i, body, slot) for each contact i, which is contact number `slot` of its body.
template <class Visit>
NEOL_INLINE void for_each_contact(const Constraints& island, Visit visit) {
  for (int i = 0, slot = 0; i < island.contacts; ++i, ++slot) {
    const int body = island.contact_body[i];
    if (i > 0 && body != island.contact_body[i - 1]) slot = 0;
    visit(i, body, slot);
  }
}

// As many worlds as a vector has lanes. Entries that a lane does not use are zero, so their
// impulses are zero. Each body has slots for its own contacts: the ground does not move, so
// contacts of different bodies are independent, and only the order of one body's contacts matters.
template <class Parts>
struct VelocityGroup {
  Velocity<Real> velocity[Parts::bodies];
  JointImpulse<Real> joint[Parts::joints];
  HingeImpulse<Real> hinge[Parts::joints];
  JointTerms<Real> joint_terms[Parts::joints];
  bool limited[Parts::joints];
  ContactImpulse<Real> contact[Parts::bodies][contact_slots];
  ContactTerms<Real> contact_terms[Parts::bodies][contact_slots];
  bool two[Parts::bodies][contact_slots];
  int contacts[Parts::bodies];

  void read(Constraints* const* islands, int count) {
    for (int i = 0; i < Parts::bodies; ++i) {
      clear(velocity[i]);
      contacts[i] = 0;
    }
    for (int i = 0; i < Parts::joints; ++i) {
      clear(joint[i]);
      clear(hinge[i]);
      clear(joint_terms[i]);
      limited[i] = false;
    }
    for (int lane = 0; lane < count; ++lane) {
      const Constraints& island = *islands[lane];
      for (int i = 0; i < Parts::bodies; ++i) put(island.state.velocity[i], velocity[i], lane);
      for (int i = 0; i < Parts::joints; ++i) {
        put(island.state.joint[i], joint[i], lane);
        put(island.hinge[i], hinge[i], lane);
        put(island.joint_terms[i], joint_terms[i], lane);
        limited[i] |= island.joint_terms[i].at_lower || island.joint_terms[i].at_upper;
      }
      for_each_contact(island, [&](int i, int body, int slot) {
        if (slot == contacts[body]) {
          clear(contact[body][slot]);
          clear(contact_terms[body][slot]);
          two[body][slot] = false;
          ++contacts[body];
        }
        put(island.state.contact[i], contact[body][slot], lane);
        put(island.contact_terms[i], contact_terms[body][slot], lane);
        two[body][slot] |= island.contact_terms[i].two != 0;
      });
    }
  }

  void write(Constraints* const* islands, int count) const {
    for (int lane = 0; lane < count; ++lane) {
      Constraints& island = *islands[lane];
      for (int i = 0; i < Parts::bodies; ++i) get(island.state.velocity[i], velocity[i], lane);
      for (int i = 0; i < Parts::joints; ++i) {
        get(island.state.joint[i], joint[i], lane);
        get(island.hinge[i], hinge[i], lane);
      }
      for_each_contact(island, [&](int i, int body, int slot) {
        get(island.state.contact[i], contact[body][slot], lane);
      });
    }
  }
};

// Two groups take turns, joint by joint: while a vector of one waits for its operands, the other's
// is computed.
template <class Parts, int groups>
void solve_velocities_of(Constraints* const* islands, int count, int iterations) {
  VelocityGroup<Parts> group[groups];
  const auto members = [&](int g) { return g + 1 < groups ? width : count - g * width; };
  for (int g = 0; g < groups; ++g) group[g].read(islands + g * width, members(g));
  for (int iteration = 0; iteration < iterations; ++iteration) {
#pragma GCC unroll 4
    for (int i = 0; i < Parts::joints; ++i)
#pragma GCC unroll 2
      for (int g = 0; g < groups; ++g)
        solve_joint(group[g].joint_terms[i], group[g].limited[i], group[g].joint[i],
                    group[g].hinge[i], group[g].velocity[Parts::body_a[i]],
                    group[g].velocity[Parts::body_b[i]]);
    for (int i = 0; i < Parts::bodies; ++i)
      for (int g = 0; g < groups; ++g)
        for (int slot = 0; slot < group[g].contacts[i]; ++slot)
          solve_contact(group[g].contact_terms[i][slot], group[g].two[i][slot],
                        group[g].contact[i][slot], group[g].velocity[i]);
  }
  for (int g = 0; g < groups; ++g) group[g].write(islands + g * width, members(g));
}

#ifdef __FMA__

#include "sines.hpp"

NEOL_INLINE void sines_of(Real angle, Real& sine, Real& cosine) {
  HalfReal half[2], sines[2], cosines[2];
  __builtin_memcpy(half, &angle, sizeof angle);
  for (int i = 0; i < 2; ++i) half_sines(half[i], sines[i], cosines[i]);
  __builtin_memcpy(&sine, sines, sizeof sine);
  __builtin_memcpy(&cosine, cosines, sizeof cosine);
}

void sines(const float* angles, float* sines, float* cosines, int count) {
  for (int i = 0; i < count; i += width) {
    Real angle, sine, cosine;
    __builtin_memcpy(&angle, angles + i, sizeof angle);
    sines_of(angle, sine, cosine);
    __builtin_memcpy(sines + i, &sine, sizeof sine);
    __builtin_memcpy(cosines + i, &cosine, sizeof cosine);
  }
}

bool any(Mask<Real> mask) {
  int found = 0;
  for (int lane = 0; lane < width; ++lane) found |= mask[lane];
  return found != 0;
}

// The same as VelocityGroup, for the position iterations. A lane is active until its errors are
// small.
template <class Parts>
struct PlaceGroup {
  Place<Real> place[Parts::bodies];
  BodyTerms<Real> body_terms[Parts::bodies];
  HingePlace<Real> hinge_place[Parts::joints];
  bool limited[Parts::joints];
  ContactPlace<Real> contact_place[Parts::bodies][contact_slots];
  Mask<Real> used[Parts::bodies][contact_slots];
  bool second[Parts::bodies][contact_slots];
  int contacts[Parts::bodies];
  Real nearest;
  Mask<Real> active, resolved, too_far;

  void read(Constraints* const* islands, int count) {
    for (int i = 0; i < Parts::bodies; ++i) {
      clear(place[i]);
      clear(body_terms[i]);
      contacts[i] = 0;
    }
    for (int i = 0; i < Parts::joints; ++i) {
      clear(hinge_place[i]);
      limited[i] = false;
    }
    active = too_far = Mask<Real>{};
    for (int lane = 0; lane < count; ++lane) {
      const Constraints& island = *islands[lane];
      active[lane] = -1;
      for (int i = 0; i < Parts::bodies; ++i) {
        put(island.place[i], place[i], lane);
        put(island.body_terms[i], body_terms[i], lane);
      }
      for (int i = 0; i < Parts::joints; ++i) {
        put(island.hinge_place[i], hinge_place[i], lane);
        limited[i] |= island.hinge_place[i].at_lower || island.hinge_place[i].at_upper;
      }
      for_each_contact(island, [&](int i, int body, int slot) {
        if (slot == contacts[body]) {
          clear(contact_place[body][slot]);
          used[body][slot] = Mask<Real>{};
          second[body][slot] = false;
          ++contacts[body];
        }
        put(island.contact_place[i], contact_place[body][slot], lane);
        used[body][slot][lane] = -1;
        second[body][slot] |= island.contact_place[i].second != 0;
      });
    }
  }

  NEOL_INLINE void rotate(Place<Real>& now) {
    too_far |= ~((now.angle < sines_end) & (now.angle > -sines_end));
    sines_of(now.angle, now.sine, now.cosine);
    now.turned = now.angle;
  }

  NEOL_INLINE void solve_contacts() {
    const auto turn = [this](Place<Real> & now) __attribute__((always_inline)) { rotate(now); };
    nearest = Real{};
    for (int i = 0; i < Parts::bodies; ++i)
      for (int slot = 0; slot < contacts[i]; ++slot) {
        const ContactPlace<Real>& contact = contact_place[i][slot];
        const Mask<Real> here = active & used[i][slot];
        solve_contact_point(contact, 0, body_terms[i], here, nearest, place[i], turn);
        if (second[i][slot])
          solve_contact_point(contact, 1, body_terms[i], here & contact.second, nearest, place[i],
                              turn);
      }
    resolved = nearest >= Real{} + least_separation;
  }

  NEOL_INLINE void solve_hinge(int i) {
    const auto turn = [this](Place<Real> & now) __attribute__((always_inline)) { rotate(now); };
    const int a = Parts::body_a[i], b = Parts::body_b[i];
    resolved &= solve_hinge_place(hinge_place[i], body_terms[a], body_terms[b], limited[i], active,
                                  place[a], place[b], turn);
  }

  // Whether a lane needs another iteration.
  bool go_on() {
    active &= ~resolved;
    return any(active);
  }

  // `left`: iterations that remain in lanes that are still active.
  void write(Constraints* const* islands, int count, int left, int* iterations_left) {
    for (int i = 0; i < Parts::bodies; ++i) rotate(place[i]);
    for (int lane = 0; lane < count; ++lane) {
      if (too_far[lane]) continue;
      Constraints& island = *islands[lane];
      for (int i = 0; i < Parts::bodies; ++i) get(island.place[i], place[i], lane);
      island.resolved = !active[lane];
      iterations_left[lane] = active[lane] ? left : 0;
    }
  }
};

template <class Parts, int groups>
void solve_places_of(Constraints* const* islands, int count, int iterations, int left,
                     int* iterations_left) {
  PlaceGroup<Parts> group[groups];
  const auto members = [&](int g) { return g + 1 < groups ? width : count - g * width; };
  for (int g = 0; g < groups; ++g) group[g].read(islands + g * width, members(g));
  bool going = true;
  for (int iteration = 0; iteration < iterations && going; ++iteration) {
    for (int g = 0; g < groups; ++g) group[g].solve_contacts();
    for (int i = 0; i < Parts::joints; ++i)
      for (int g = 0; g < groups; ++g) group[g].solve_hinge(i);
    going = false;
    for (int g = 0; g < groups; ++g) going |= group[g].go_on();
  }
  for (int g = 0; g < groups; ++g)
    group[g].write(islands + g * width, members(g), left, iterations_left + g * width);
}

#endif

template <class Parts>
void solve_velocities_in_groups(Constraints* const* islands, int count, int iterations) {
  for (; count > 0; islands += 2 * width, count -= 2 * width)
    if (count > width)
      solve_velocities_of<Parts, 2>(islands, count < 2 * width ? count : 2 * width, iterations);
    else
      solve_velocities_of<Parts, 1>(islands, count, iterations);
}

void solve_velocities(Constraints* const* islands, int count, int iterations) {
  if (count == 0) return;
  if (islands[0]->joints == LunarLanderParts::joints)
    solve_velocities_in_groups<LunarLanderParts>(islands, count, iterations);
  else
    solve_velocities_in_groups<BipedalWalkerParts>(islands, count, iterations);
}

#ifdef __FMA__

template <class Parts>
void solve_places_in_groups(Constraints* const* islands, int count, int iterations, int left,
                            int* iterations_left) {
  for (; count > 0; islands += 2 * width, iterations_left += 2 * width, count -= 2 * width)
    if (count > width)
      solve_places_of<Parts, 2>(islands, count < 2 * width ? count : 2 * width, iterations, left,
                                iterations_left);
    else
      solve_places_of<Parts, 1>(islands, count, iterations, left, iterations_left);
}

void solve_places(Constraints* const* islands, int count, int iterations, int left,
                  int* iterations_left) {
  if (count == 0) return;
  if (islands[0]->joints == LunarLanderParts::joints)
    solve_places_in_groups<LunarLanderParts>(islands, count, iterations, left, iterations_left);
  else
    solve_places_in_groups<BipedalWalkerParts>(islands, count, iterations, left, iterations_left);
}

#endif

}  // namespace

namespace vectors {
#ifdef __FMA__
const Lanes NEOL_LANES = {width, solve_velocities, solve_places, sines};
#else
const Lanes NEOL_LANES = {width, solve_velocities, nullptr, nullptr};
#endif
}  // namespace vectors

}  // namespace neol

#endif
