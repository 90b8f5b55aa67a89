/* Tests ${p}_control.hpp against numbers of the scene: c++ -std=c++11 ${p}_control_test.cpp with ${p}.c as C. */
#include "${p}_control.hpp"

#include <cmath>
#include <cstdio>

namespace control = ${p}_control;

static const double times[] = {$times};
static const double efforts[][control::drives_count] = {
$efforts};
static const double off[] = {$off};

static int failed = 0;

static void expect(bool holds, const char* what, unsigned instant) {
  if (holds) return;
  std::printf("instant %u: %s\n", instant, what);
  ++failed;
}

int main() {
  control::Control mechanism;
  control::Motion q, dq, ddq;
  control::Efforts tau, still;
  control::Inertia inertia;
  double before = times[0];
  expect(mechanism.configure() == ${P}_OK, "configure", 0);
  for (unsigned k = 0; k < sizeof times/sizeof *times; ++k) {
    const int steps = k ? $steps : 1;
    for (int n = 1; n <= steps; ++n) {
      const double t = n == steps ? times[k] : before + n*(times[k] - before)/steps;
      expect(mechanism.motion(t, q, dq, ddq) == ${P}_OK, "motion", k);
      expect(mechanism.efforts(q, dq, ddq, tau$t) == ${P}_OK, "efforts", k);
    }
    before = times[k];
    for (unsigned i = 0; i < control::drives_count; ++i) {
      expect(std::fabs(tau[i] - efforts[k][i]) <= off[i], control::drives[i], k);
    }
    expect(mechanism.reflected_inertia(q, dq, inertia$t_before) == ${P}_OK, "reflected inertia", k);
    const control::Motion rest = {};
    expect(mechanism.efforts(q, dq, rest, still$t_before) == ${P}_OK, "efforts without acceleration", k);
    for (unsigned i = 0; $linear && i < control::drives_count; ++i) {
      double sum = still[i], size = std::fabs(still[i]);
      for (unsigned j = 0; j < control::coordinates_count; ++j) {
        sum += inertia[i][j]*ddq[j];
        size += std::fabs(inertia[i][j]*ddq[j]);
      }
      /* Of differences the rounding of what is subtracted is left, times accelerations. */
      for (unsigned j = 0; j < control::coordinates_count; ++j) size += std::fabs(still[i]*ddq[j]);
      expect(std::fabs(sum - tau[i]) <= off[i] + $rounding*size, "reflected inertia times acceleration", k);
    }
  }
  std::printf("%s: %d failures\n", "${p}_control", failed);
  return failed != 0;
}
