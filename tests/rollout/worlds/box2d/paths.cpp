// `paths sines PATH`: compares the lanes' sines and cosines with the C library's, of every angle
// that the lanes take and that is not its own sine. Prints how many were compared, and differ.
//
// Else plays episodes of a task twice, a batch of simulations on a path and each of them on the
// plain one, and compares observations, rewards and ends after each step, and on a share of the
// steps all that the worlds hold. Prints how many steps were compared, how many worlds failed an
// assertion of Box2D, and the path; at the first difference, what differs, and exits with 1.
//
// Arguments: path, task, size of the batch, steps of it, velocity iterations, every how many steps
// the worlds are compared whole. The third walker is given actions that are not numbers, once.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bipedal_walker.hpp"
#include "lanes.hpp"
#include "lockstep.hpp"
#include "lunar_lander.hpp"

namespace {

using neol::Path;
using neol::Simulation;

constexpr const char* path_names[] = {"plain", "shortcut", "sse2", "avx2", "avx512", "neon"};

// What a world holds, in words with names.
struct Snapshot {
  std::vector<std::pair<const char*, double>> numbers;
  void add(const char* name, double number) { numbers.emplace_back(name, number); }
  void add(const char* name, const b2Vec2& vector) {
    add(name, vector.x);
    add(name, vector.y);
  }

  explicit Snapshot(const b2World& world) {
    for (const b2Body* body = world.GetBodyList(); body; body = body->GetNext()) {
      if (body->GetType() == b2_staticBody && !body->GetContactList()) continue;
      add("position", body->m_xf.p);
      add("sine", body->m_xf.q.s);
      add("cosine", body->m_xf.q.c);
      add("centre", body->m_sweep.c);
      add("angle", body->m_sweep.a);
      add("centre before", body->m_sweep.c0);
      add("angle before", body->m_sweep.a0);
      add("velocity", body->m_linearVelocity);
      add("turning", body->m_angularVelocity);
      add("force", body->m_force);
      add("torque", body->m_torque);
      if (body->GetType() == b2_staticBody) continue;
      add("awake", body->IsAwake());
      add("resting", body->m_sleepTime);
      for (const b2Fixture* fixture = body->GetFixtureList(); fixture; fixture = fixture->GetNext())
        for (int i = 0; i < fixture->m_proxyCount; ++i) {
          const b2AABB& box =
              world.GetContactManager().m_broadPhase.GetFatAABB(fixture->m_proxies[i].proxyId);
          add("box", box.lowerBound);
          add("box", box.upperBound);
        }
    }
    add("tree", world.GetTreeHeight());
    add("tree", world.GetTreeBalance());
    for (const b2Joint* each = world.GetJointList(); each; each = each->GetNext()) {
      const auto* joint = static_cast<const b2RevoluteJoint*>(each);
      add("hinge", joint->m_impulse.x);
      add("hinge", joint->m_impulse.y);
      add("limit", joint->m_impulse.z);
      add("motor", joint->m_motorImpulse);
      add("limit state", joint->m_limitState);
    }
    for (const b2Contact* contact = world.GetContactList(); contact; contact = contact->GetNext()) {
      add("flags", contact->m_flags);
      add("time of impact", contact->m_toi);
      add("impacts", contact->m_toiCount);
      add("points", contact->m_manifold.pointCount);
      for (int i = 0; i < contact->m_manifold.pointCount; ++i) {
        const b2ManifoldPoint& point = contact->m_manifold.points[i];
        add("point", point.localPoint);
        add("normal impulse", point.normalImpulse);
        add("tangent impulse", point.tangentImpulse);
        add("point id", point.id.key);
      }
    }
  }
};

bool same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0;
}

std::unique_ptr<Simulation> make(int task) {
  if (task == 0) return std::make_unique<neol::LunarLander>();
  return std::make_unique<neol::BipedalWalker>(task == 2);
}

// A simulation and its twin on the plain path, steered by a random linear policy,
// or a lander by one that lands.
class Pair {
 public:
  Pair(int pair_task, unsigned seed)
      : task(pair_task), random(seed), tested(make(task)), plain(make(task)) {}

  void begin() {
    const std::uint64_t stream[4] = {random(), random(), random(), random() | 1};
    std::normal_distribution<double> normal(0, std::bernoulli_distribution(0.3)(random) ? 3 : 1);
    for (double& weight : weights) weight = normal(random);
    tested->reset(neol::Pcg64(stream), observation);
    plain->begin(neol::Pcg64(stream));
    plain->advance(plain->idle);
    double reward, expected[24] = {};
    plain->observe(plain->idle, expected, &reward);
    for (int i = 0; i < 24; ++i)
      if (!same(observation[i], expected[i])) std::printf("a reset differs\n"), std::exit(1);
    lands = task == 0 && std::bernoulli_distribution(0.5)(random);
    steps_left = std::uniform_int_distribution(50, 700)(random);
  }

  // The next action.
  void decide(bool poisoned) {
    const int inputs = task == 0 ? 8 : 24;
    double outputs[4];
    for (int i = 0; i < 4; ++i) {
      double sum = weights[i * 25 + inputs];
      for (int j = 0; j < inputs; ++j) sum += weights[i * 25 + j] * observation[j];
      outputs[i] = std::tanh(sum);
      action[i] = static_cast<float>(outputs[i]);
    }
    if (task == 0) {
      int best = 0;
      for (int i = 1; i < 4; ++i)
        if (outputs[i] > outputs[best]) best = i;
      action[0] = static_cast<float>(lands ? land() : best);
    }
    if (poisoned) action[1] = action[3] = std::nanf("");
  }

  // Gymnasium's own demonstration for the lander, which ends on both legs.
  int land() const {
    const double* s = observation;
    const bool down = s[6] > 0 || s[7] > 0;
    const double tilt = std::clamp(0.5 * s[0] + s[2], -0.4, 0.4);
    const double turn = down ? 0 : 0.5 * (tilt - s[4]) - s[5];
    const double lift = down ? -0.5 * s[3] : 0.5 * (0.55 * std::abs(s[0]) - s[1]) - 0.5 * s[3];
    if (lift > std::abs(turn) && lift > 0.05) return 2;
    return turn < -0.05 ? 3 : turn > 0.05 ? 1 : 0;
  }

  bool step_plain() {
    try {
      plain->advance(action);
      return true;
    } catch (const b2AssertException&) {
      return false;
    }
  }

  int task;
  std::mt19937_64 random;
  std::unique_ptr<Simulation> tested, plain;
  double weights[4 * 25] = {}, observation[24] = {};
  float action[4] = {};
  bool lands = false;
  int steps_left = 0;
};

// Of both signs.
void compare_sines(const neol::Lanes& lanes) {
  std::uint32_t begin, end;
  const float smallest = 0x1p-13f;
  std::memcpy(&begin, &smallest, sizeof begin);
  std::memcpy(&end, &neol::sines_end, sizeof end);
  constexpr int block = 1 << 12;
  std::vector<float> angles(block), sines(block), cosines(block);
  std::uint64_t compared = 0, different = 0;
  for (const std::uint32_t sign : {0u, 1u << 31})
    for (std::uint32_t next = begin; next < end; next += block) {
      for (std::uint32_t i = 0; i < block; ++i) {
        const std::uint32_t bits = std::min(next + i, end - 1) | sign;
        std::memcpy(&angles[i], &bits, sizeof bits);
      }
      lanes.sines(angles.data(), sines.data(), cosines.data(), block);
      for (std::size_t i = 0; i < block; ++i) {
        ++compared;
        different += sines[i] != std::sin(angles[i]) || cosines[i] != std::cos(angles[i]);
      }
    }
  std::printf("%llu %llu\n", static_cast<unsigned long long>(compared),
              static_cast<unsigned long long>(different));
}

Path path_of(const std::string& name) {
  int index = 0;
  while (path_names[index] != name) ++index;
  return static_cast<Path>(index);
}

}  // namespace

int main(int count, char** arguments) {
  const std::string name = arguments[count > 3 ? 1 : 2];
  const Path path = path_of(name);
  const neol::Lanes* lanes = neol::lanes_of(path);
  if (!neol::available(path) || (count == 3 && !neol::has_exact_sines(path))) {
    std::printf("unavailable\n");
    return 0;
  }
  if (count == 3) {
    compare_sines(*lanes);
    return 0;
  }
  const int task = std::atoi(arguments[2]), size = std::atoi(arguments[3]);
  const int steps = std::atoi(arguments[4]), iterations = std::atoi(arguments[5]);
  const int whole_every = std::atoi(arguments[6]);

  std::vector<Pair> pairs;
  for (int i = 0; i < size; ++i) pairs.emplace_back(task, static_cast<unsigned>(1000 * task + i));
  for (Pair& pair : pairs) pair.begin();
  int compared = 0, failed = 0;
  for (int step = 0; step < steps; ++step) {
    std::vector<Simulation*> simulations;
    std::vector<const float*> actions;
    for (int i = 0; i < size; ++i) {
      pairs[static_cast<std::size_t>(i)].decide(step == 40 && i == 2);
      pairs[static_cast<std::size_t>(i)].tested->velocity_iterations = iterations;
      simulations.push_back(pairs[static_cast<std::size_t>(i)].tested.get());
      actions.push_back(pairs[static_cast<std::size_t>(i)].action);
    }
    neol::advance_all(path, simulations.data(), actions.data(), size);
    for (int i = 0; i < size; ++i) {
      Pair& pair = pairs[static_cast<std::size_t>(i)];
      const bool fine = pair.step_plain();
      if (fine == pair.tested->failed) {
        std::printf("step %d, simulation %d: one path fails, one does not\n", step, i);
        return 1;
      }
      if (!fine) {
        ++failed;
        pair.tested->abandon();
        pair.plain->abandon();
        pair.begin();
        continue;
      }
      double reward, expected_reward, expected[24] = {};
      const bool ended = pair.tested->observe(pair.action, pair.observation, &reward);
      const bool expected_ended = pair.plain->observe(pair.action, expected, &expected_reward);
      bool equal = same(reward, expected_reward) && ended == expected_ended;
      for (int j = 0; j < 24; ++j) equal &= same(pair.observation[j], expected[j]);
      ++compared;
      if ((step + i) % whole_every == 0) {
        const Snapshot here(*pair.tested->world), there(*pair.plain->world);
        if (here.numbers.size() != there.numbers.size()) {
          std::printf("step %d, simulation %d: other contacts\n", step, i);
          return 1;
        }
        for (std::size_t j = 0; j < here.numbers.size(); ++j)
          if (!same(here.numbers[j].second, there.numbers[j].second)) {
            std::printf("step %d, simulation %d: %s %.9g instead of %.9g\n", step, i,
                        here.numbers[j].first, here.numbers[j].second, there.numbers[j].second);
            return 1;
          }
      }
      if (!equal) {
        std::printf("step %d, simulation %d: observation, reward or end differs\n", step, i);
        return 1;
      }
      if (ended || --pair.steps_left == 0) pair.begin();
    }
  }
  std::printf("%d %d %s\n", compared, failed, name.c_str());
}
