#include "lockstep.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lanes.hpp"
#include "shortcut.hpp"

namespace neol {

namespace {

// Null where the path has none.
const Lanes* lanes_of(Path path) {
  switch (path) {
#if defined(__x86_64__)
    case Path::sse2:
      return &sse2;
    case Path::avx2:
      return &avx2;
    case Path::avx512:
      return &avx512;
#elif defined(__aarch64__)
    case Path::neon:
      return &neon;
#endif
    default:
      return nullptr;
  }
}

// Does a part of a step in a simulation that has not failed so far.
template <class Part>
void attempt(Simulation* simulation, Part part) {
  if (simulation->failed) return;
  try {
    part(*simulation);
  } catch (const b2AssertException&) {
    simulation->failed = true;
  }
}

bool has_slots(const Constraints& island) {
  int of_body[max_bodies] = {};
  for (int i = 0; i < island.contacts; ++i)
    if (++of_body[island.contact_body[i]] > contact_slots) return false;
  return true;
}

}  // namespace

bool available(Path path) {
  switch (path) {
    case Path::plain:
    case Path::shortcut:
      return true;
#if defined(__x86_64__)
    case Path::sse2:
      return true;
    case Path::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case Path::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512dq");
#elif defined(__aarch64__)
    case Path::neon:
      return true;
#endif
    default:
      return false;
  }
}

Path best_path() {
  for (const Path path : {Path::avx512, Path::avx2, Path::neon, Path::sse2})
    if (available(path)) return path;
  return Path::shortcut;
}

bool has_our_sines(const Lanes& lanes) {
  // Without fused multiply-adds, the C library gives 34 other values of 350 million, among them
  // those of the first five angles. The others are a sample of all.
  std::vector<float> angles = {0x1.1475b6p+4f, 0x1.1475b8p+4f, 0x1.1475bap+4f, 0x1.1475bcp+4f,
                               0x1.78edb2p+4f};
  for (float angle = 0x1p-14f; angle < sines_end; angle *= 1.00037f)
    angles.insert(angles.end(), {angle, -angle});
  while (angles.size() % static_cast<std::size_t>(lanes.width) != 0) angles.push_back(0);
  std::vector<float> sines(angles.size()), cosines(angles.size());
  lanes.sines(angles.data(), sines.data(), cosines.data(), static_cast<int>(angles.size()));
  for (std::size_t i = 0; i < angles.size(); ++i)
    if (sines[i] != std::sin(angles[i]) || cosines[i] != std::cos(angles[i])) return false;
  return true;
}

namespace {

bool places_in(const Lanes& lanes) {
  if (!lanes.sines) return false;
  static const bool with_avx2 = available(Path::avx2) && has_our_sines(*lanes_of(Path::avx2));
  return with_avx2;
}

// Steps of a batch that are to be solved here.
class Batch {
 public:
  Batch(const Lanes* lanes, int velocity_iterations, int position_iterations)
      : lanes_(lanes),
        velocity_iterations_(velocity_iterations),
        position_iterations_(position_iterations) {}

  void add(TimeStep& step) {
    steps_.push_back(&step);
    if (lanes_ && has_slots(step.island))
      together_.push_back(&step.island);
    else
      alone_.push_back(&step.island);
  }

  void solve() {
    // Worlds with as many contacts keep company, so that few lanes wait for contacts of others.
    std::sort(together_.begin(), together_.end(), [](const Constraints* a, const Constraints* b) {
      return a->contacts > b->contacts;
    });
    constexpr std::size_t worth_it = 3;  // fewer worlds are faster one by one
    while (lanes_ && !together_.empty() &&
           together_.size() % static_cast<std::size_t>(lanes_->width) < worth_it &&
           together_.size() % static_cast<std::size_t>(lanes_->width) > 0) {
      alone_.push_back(together_.back());
      together_.pop_back();
    }
    for (Constraints* island : alone_) solve_velocities(*island, velocity_iterations_);
    const int count = static_cast<int>(together_.size());
    if (count > 0) lanes_->solve_velocities(together_.data(), count, velocity_iterations_);
    for (TimeStep* step : steps_) step->integrate();
    for (Constraints* island : alone_) solve_places(*island, position_iterations_);
    solve_places_together();
  }

 private:
  // Most errors are small after a few iterations; lanes that go on then close their ranks.
  void solve_places_together() {
    constexpr int first = 3;
    std::vector<int> left(together_.size(), position_iterations_);
    if (lanes_ && places_in(*lanes_) && position_iterations_ > first) {
      const auto solve_rest = [&](int iterations, int rest) {
        std::vector<Constraints*> unsolved;
        std::vector<std::size_t> index;
        for (std::size_t i = 0; i < together_.size(); ++i)
          if (left[i] == iterations + rest) {
            unsolved.push_back(together_[i]);
            index.push_back(i);
          }
        std::vector<int> left_there(unsolved.size(), iterations + rest);
        lanes_->solve_places(unsolved.data(), static_cast<int>(unsolved.size()), iterations, rest,
                             left_there.data());
        for (std::size_t i = 0; i < index.size(); ++i) left[index[i]] = left_there[i];
      };
      solve_rest(first, position_iterations_ - first);
      solve_rest(position_iterations_ - first, 0);
    }
    for (std::size_t i = 0; i < together_.size(); ++i)
      if (left[i] > 0) solve_places(*together_[i], left[i]);
  }

  const Lanes* lanes_;
  int velocity_iterations_, position_iterations_;
  std::vector<TimeStep*> steps_;
  std::vector<Constraints*> together_, alone_;
};

}  // namespace

void advance_all(Path path, Simulation* const* simulations, const float* const* actions,
                 int count) {
  if (path == Path::plain) {
    for (int i = 0; i < count; ++i)
      attempt(simulations[i], [&](Simulation& simulation) { simulation.advance(actions[i]); });
    return;
  }
  if (count == 0) return;
  Batch batch(lanes_of(path), simulations[0]->velocity_iterations,
              simulations[0]->position_iterations);
  for (int i = 0; i < count; ++i)
    attempt(simulations[i], [&](Simulation& simulation) {
      simulation.act(actions[i]);
      if (simulation.time_step.begin(simulation.seconds, simulation.velocity_iterations,
                                     simulation.position_iterations))
        batch.add(simulation.time_step);
    });
  batch.solve();
  for (int i = 0; i < count; ++i)
    attempt(simulations[i], [&](Simulation& simulation) {
      simulation.time_step.finish();
      simulation.sense();
    });
}

}  // namespace neol
