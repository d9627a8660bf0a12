// Compiled once for each kind of vector, NEOL_LANES its name; without, there is nothing here.
#include "lanes.hpp"

#ifdef NEOL_LANES

#if defined(__AVX512F__)
#define NEOL_WIDTH 16
#elif defined(__AVX2__)
#define NEOL_WIDTH 8
#else
#define NEOL_WIDTH 4
#endif

namespace neol {
namespace NEOL_LANES {

const int width = NEOL_WIDTH;

namespace {

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

// As many worlds as a vector has lanes. Of what a lane does not use, all is zero, and no impulse
// comes of it. A body's contacts have slots of their own: since the ground does not move, contacts
// of different bodies do not meet, and only the order of one body's own matters.
template <class Parts>
struct Group {
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
      for (int i = 0, slot = 0; i < island.contacts; ++i, ++slot) {
        const int body = island.contact_body[i];
        if (i > 0 && body != island.contact_body[i - 1]) slot = 0;
        if (slot == contacts[body]) {
          clear(contact[body][slot]);
          clear(contact_terms[body][slot]);
          two[body][slot] = false;
          ++contacts[body];
        }
        put(island.state.contact[i], contact[body][slot], lane);
        put(island.contact_terms[i], contact_terms[body][slot], lane);
        two[body][slot] |= island.contact_terms[i].two != 0;
      }
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
      for (int i = 0, slot = 0; i < island.contacts; ++i, ++slot) {
        const int body = island.contact_body[i];
        if (i > 0 && body != island.contact_body[i - 1]) slot = 0;
        get(island.state.contact[i], contact[body][slot], lane);
      }
    }
  }
};

// Two groups take turns, joint by joint: while a vector of one waits for its operands, the other's
// is computed.
template <class Parts, int groups>
void iterate_groups(Constraints* const* islands, int count, int iterations) {
  Group<Parts> group[groups];
  const auto members = [&](int g) {
    return g + 1 < groups ? width : count - g * width;
  };
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

template <class Parts>
void iterate_parts(Constraints* const* islands, int count, int iterations) {
  while (count > 0) {
    const int now = count < 2 * width ? count : 2 * width;
    if (now > width)
      iterate_groups<Parts, 2>(islands, now, iterations);
    else
      iterate_groups<Parts, 1>(islands, now, iterations);
    islands += now;
    count -= now;
  }
}

}  // namespace

void iterate(Constraints* const* islands, int count, int iterations) {
  if (count == 0) return;
  if (islands[0]->joints == LunarLanderParts::joints)
    iterate_parts<LunarLanderParts>(islands, count, iterations);
  else
    iterate_parts<BipedalWalkerParts>(islands, count, iterations);
}

}  // namespace NEOL_LANES
}  // namespace neol

#endif
