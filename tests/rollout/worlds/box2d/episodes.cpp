// For the sanitizers: on every path a hundred episodes of random actions per task through the C
// interface, in a group whose slots begin anew when an episode has ended or taken 100 steps. Prints
// how many steps each path of each task took.
#include <cstdint>
#include <cstdio>
#include <random>

struct Group;
extern "C" {
bool neol_available(int path);
Group* neol_create(int task, int slots, int path);
void neol_destroy(Group* group);
void neol_reset(Group* group, std::int64_t slot, const std::uint64_t stream[4],
                double* observation);
void neol_step(Group* group, std::int64_t count, const std::int64_t* slots, const float* actions,
               double* observations, double* rewards, bool* ended);
void neol_physics(Group* group, const float* actions, int width, int steps);
}

constexpr int slots = 20, paths = 6, episodes = 100;

int play(int task, int path) {
  std::mt19937_64 random;
  std::uniform_real_distribution<float> strength(-1, 1);
  std::uniform_int_distribution<int> engine(0, 3);
  Group* group = neol_create(task, slots, path);
  const int size = task == 0 ? 8 : 24;
  double observations[slots * 24], rewards[slots];
  float actions[slots * 4] = {};
  bool ended[slots];
  std::int64_t playing[slots];
  int left = episodes, count = 0, steps = 0, age[slots] = {};

  const auto begin = [&](std::int64_t slot) {
    const std::uint64_t stream[4] = {random(), random(), random(), random() | 1};
    neol_reset(group, slot, stream, observations + slot * size);
    age[slot] = 0;
    --left;
  };
  while (count < slots) begin(playing[count] = count), ++count;
  while (count > 0) {
    for (float& number : actions)
      number = task == 0 ? static_cast<float>(engine(random)) : strength(random);
    neol_step(group, count, playing, actions, observations, rewards, ended);
    steps += count;
    for (int i = count - 1; i >= 0; --i) {
      const std::int64_t slot = playing[i];
      if (!ended[slot] && ++age[slot] < 100) continue;
      if (left > 0)
        begin(slot);
      else
        playing[i] = playing[--count];
    }
  }
  begin(0);
  neol_physics(group, actions, 4, 1);
  neol_destroy(group);
  return steps;
}

int main() {
  for (int task = 0; task < 3; ++task)
    for (int path = 0; path < paths; ++path)
      if (neol_available(path)) std::printf("%d\n", play(task, path));
}
