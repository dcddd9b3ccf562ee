#include "protocol/api/gauss_rings.h"

#include <cmath>
#include <numbers>

namespace gonio::api {

namespace {

struct Legendre {
  double value = 0.0;
  double slope = 0.0;
};

Legendre legendre(int n, double x) {
  double before = 1.0;
  double p = x;
  for (int k = 2; k <= n; ++k) {
    const double next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k;
    before = p;
    p = next;
  }
  return {p, n * (x * p - before) / (x * x - 1.0)};
}

double node(int n, int k) {
  double x = std::cos(std::numbers::pi * (k + 0.75) / (n + 0.5));  // Tricomi's first guess
  constexpr int kSteps = 8;                                        // from there three are enough for all digits
  for (int step = 0; step < kSteps; ++step) {
    const Legendre p = legendre(n, x);
    x -= p.value / p.slope;
  }
  return x;
}

}  // namespace

std::vector<GaussRing> gauss_rings(int count, Angle to) {
  const double sine = std::sin(to.si());
  const double span = sine * sine;  // of u, down from 1 at the normal
  std::vector<GaussRing> rings;
  for (int k = 0; k < count; ++k) {
    const double x = node(count, k);
    const double slope = legendre(count, x).slope;
    const double gauss = 2.0 / ((1.0 - x * x) * slope * slope);
    const double sine2 = 0.5 * (1.0 - x) * span;
    rings.push_back({radians(std::asin(std::sqrt(sine2))), 0.5 * std::numbers::pi * span * gauss});
  }
  return rings;
}

}  // namespace gonio::api
