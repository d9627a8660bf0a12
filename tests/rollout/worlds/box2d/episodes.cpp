// For the sanitizers: a hundred episodes of random actions per task through the C interface, each
// ended or, after 100 steps, left for the next. Prints how many steps each task took.
#include <cstdint>
#include <cstdio>
#include <random>

struct Simulation;
extern "C" {
Simulation* neol_create(int task);
void neol_destroy(Simulation* simulation);
int neol_reset(Simulation* simulation, const std::uint64_t stream[4], double* observation);
int neol_step(Simulation* simulation, const float* action, double* observation, double* reward);
void neol_physics(Simulation* simulation, const float* actions, int width, int steps);
}

int main() {
  std::mt19937_64 random;
  std::uniform_real_distribution<float> strength(-1, 1);
  std::uniform_int_distribution<int> engine(0, 3);
  for (int task = 0; task < 3; ++task) {
    Simulation* simulation = neol_create(task);
    double observation[24], reward;
    float action[4] = {};
    int steps = 0;
    for (int episode = 0; episode < 100; ++episode) {
      const std::uint64_t stream[4] = {random(), random(), random(), random() | 1};
      neol_reset(simulation, stream, observation);
      for (int step = 0, ended = 0; step < 100 && !ended; ++step, ++steps) {
        for (float& number : action)
          number = task == 0 ? static_cast<float>(engine(random)) : strength(random);
        ended = neol_step(simulation, action, observation, &reward);
      }
      neol_physics(simulation, action, 4, 1);
    }
    neol_destroy(simulation);
    std::printf("%d\n", steps);
  }
}
