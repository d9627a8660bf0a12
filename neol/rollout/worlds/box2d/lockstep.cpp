#include "lockstep.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "shortcut.hpp"

namespace neol {

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
      return available(Path::avx2) && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
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

const Lanes* lanes_of(Path path) {
  switch (path) {
#if defined(__x86_64__)
    case Path::sse2:
      return &vectors::sse2;
    case Path::avx2:
      return &vectors::avx2;
    case Path::avx512:
      return &vectors::avx512;
#elif defined(__aarch64__)
    case Path::neon:
      return &vectors::neon;
#endif
    default:
      return nullptr;
  }
}

namespace {

// The C library that the lanes imitate has two versions of its sines, one without fused
// multiply-adds. They differ in 34 of 350 million angles, the first five here among them. Other
// C libraries differ much more often, which a sample shows.
bool sines_are_exact(const Lanes& lanes) {
  std::vector<float> angles = {0x1.1475b6p+4f, 0x1.1475b8p+4f, 0x1.1475bap+4f, 0x1.1475bcp+4f,
                               0x1.78edb2p+4f};
  for (float angle = 0x1p-14f; angle < sines_end; angle *= 1.0004f)
    angles.insert(angles.end(), {angle, -angle});
  while (angles.size() % static_cast<std::size_t>(lanes.width) != 0) angles.push_back(0);
  std::vector<float> sines(angles.size()), cosines(angles.size());
  lanes.sines(angles.data(), sines.data(), cosines.data(), static_cast<int>(angles.size()));
  for (std::size_t i = 0; i < angles.size(); ++i)
    if (sines[i] != std::sin(angles[i]) || cosines[i] != std::cos(angles[i])) return false;
  return true;
}

bool have_exact_sines(Path path) {
  const Lanes* lanes = available(path) ? lanes_of(path) : nullptr;
  return lanes && lanes->sines && sines_are_exact(*lanes);
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

// The steps of a batch between their beginning and their end.
class Batch {
 public:
  explicit Batch(Path path) : lanes_(lanes_of(path)), with_sines_(has_exact_sines(path)) {}

  void add(TimeStep& step) {
    steps_.push_back(&step);
    (lanes_ && has_slots(step.island) ? together_ : alone_).push_back(&step.island);
  }

  void solve(int velocity_iterations, int position_iterations) {
    arrange();
    if (!together_.empty())
      lanes_->solve_velocities(together_.data(), static_cast<int>(together_.size()),
                               velocity_iterations);
    for (Constraints* island : alone_) solve_velocities(*island, velocity_iterations);
    for (TimeStep* step : steps_) step->integrate();
    if (with_sines_) {
      solve_places_together(position_iterations);
    } else {
      for (Constraints* island : together_) solve_places(*island, position_iterations);
    }
    for (Constraints* island : alone_) solve_places(*island, position_iterations);
  }

 private:
  // Worlds with equally many contacts share vectors, so that few lanes wait for contacts of others.
  // A vector with few worlds would take longer than these worlds one by one.
  void arrange() {
    std::sort(together_.begin(), together_.end(),
              [](const Constraints* a, const Constraints* b) { return a->contacts > b->contacts; });
    constexpr std::size_t few = 2;
    const std::size_t width = lanes_ ? static_cast<std::size_t>(lanes_->width) : 1;
    const std::size_t rest = together_.size() % width;
    if (rest > few) return;
    alone_.insert(alone_.end(), together_.end() - static_cast<std::ptrdiff_t>(rest),
                  together_.end());
    together_.resize(together_.size() - rest);
  }

  // Most errors are small after a few iterations; the remaining worlds are then packed together.
  void solve_places_together(int iterations) {
    constexpr int few = 3;
    std::vector<Constraints*> unsolved = together_;
    for (int made = std::min(few, iterations); made > 0; made = iterations) {
      iterations -= made;
      std::vector<int> left(unsolved.size(), made + iterations);
      lanes_->solve_places(unsolved.data(), static_cast<int>(unsolved.size()), made, iterations,
                           left.data());
      std::vector<Constraints*> next;
      for (std::size_t i = 0; i < unsolved.size(); ++i) {
        if (left[i] > iterations)  // not solved: an angle is too large
          solve_places(*unsolved[i], left[i]);
        else if (left[i] > 0)
          next.push_back(unsolved[i]);
      }
      unsolved.swap(next);
    }
  }

  const Lanes* lanes_;
  bool with_sines_;
  std::vector<TimeStep*> steps_;
  std::vector<Constraints*> together_, alone_;
};

}  // namespace

bool has_exact_sines(Path path) {
  static const bool with_avx2 = have_exact_sines(Path::avx2);
  static const bool with_avx512 = have_exact_sines(Path::avx512);
  return (path == Path::avx2 && with_avx2) || (path == Path::avx512 && with_avx512);
}

void advance_all(Path path, Simulation* const* simulations, const float* const* actions,
                 int count) {
  if (count == 0) return;
  if (path == Path::plain) {
    for (int i = 0; i < count; ++i)
      attempt(simulations[i], [&](Simulation& simulation) { simulation.advance(actions[i]); });
    return;
  }
  const int velocity_iterations = simulations[0]->velocity_iterations;
  constexpr int position_iterations = Simulation::position_iterations;
  Batch batch(path);
  for (int i = 0; i < count; ++i)
    attempt(simulations[i], [&](Simulation& simulation) {
      simulation.act(actions[i]);
      if (simulation.time_step.begin(simulation.seconds, velocity_iterations, position_iterations))
        batch.add(simulation.time_step);
    });
  batch.solve(velocity_iterations, position_iterations);
  for (int i = 0; i < count; ++i)
    attempt(simulations[i], [&](Simulation& simulation) {
      simulation.time_step.finish();
      simulation.sense();
    });
}

}  // namespace neol
