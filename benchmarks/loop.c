/* The yardstick of network and plasticity: the loop of neol.network.forward.forward and
 * neol.network.plasticity.learn over recorded episodes, as plain C for `cc -O3`. It gives the same bits. */
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { NONE, HEBB, OJA, BCM };

static double clip(double x, double limit) { return x < -limit ? -limit : x > limit ? limit : x; }

static void forward(int64_t first, int64_t last, const double *bias, const int64_t *edge_offset,
                    const int64_t *source, const double *weight, int64_t inputs, double sum_limit,
                    double *values) {
  for (int64_t node = first; node < last; ++node) {
    double total = bias[node];
    for (int64_t edge = edge_offset[node]; edge < edge_offset[node + 1]; ++edge)
      total += weight[edge] * values[source[edge]];
    values[inputs + node - first] = tanh(clip(total, sum_limit));
  }
}

static int learn(int64_t first, int64_t last, const int64_t *edge_offset, const int64_t *source,
                 double *weight, double *threshold, int64_t inputs, int rule, double gate,
                 double threshold_rate, double weight_limit, const double *values) {
  if (rule == NONE) return 1;
  int finite = 1;
  for (int64_t node = first; node < last; ++node) {
    const double y = values[inputs + node - first], theta = threshold[node];
    for (int64_t edge = edge_offset[node]; edge < edge_offset[node + 1]; ++edge) {
      const double x = values[source[edge]];
      double w = weight[edge];
      if (rule == HEBB)
        w += gate * (x * y);
      else if (rule == OJA)
        w += gate * (y * (x - y * w));
      else
        w += gate * (y * (y - theta) * x);
      finite &= isfinite(w) != 0;
      weight[edge] = clip(w, weight_limit);
    }
    if (rule == BCM) threshold[node] = theta + threshold_rate * (y * y - theta);
  }
  return finite;
}

/* Network g plays episode g: a row of observations for its reset and one for each of its steps. */
int play_back(int64_t networks, const int64_t *node_offset, const double *bias,
              const int64_t *edge_offset, const int64_t *source, double *weight, double *threshold,
              int64_t inputs, double sum_limit, int rule, double rate, double threshold_rate,
              double weight_limit, const int64_t *steps, const double *observation,
              const double *reward, double *values) {
  int finite = 1;
  for (int64_t g = 0; g < networks; ++g) {
    const int64_t first = node_offset[g], last = node_offset[g + 1];
    for (int64_t step = 0; step < steps[g]; ++step) {
      memcpy(values, observation, (size_t)inputs * sizeof *values);
      observation += inputs;
      ++reward;
      forward(first, last, bias, edge_offset, source, weight, inputs, sum_limit, values);
      finite &= learn(first, last, edge_offset, source, weight, threshold, inputs, rule,
                      rate * *reward, threshold_rate, weight_limit, values);
    }
    observation += inputs;
    ++reward;
  }
  return finite;
}
