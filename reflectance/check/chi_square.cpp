#include "reflectance/check/chi_square.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace gonio::reflectance {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Both sums need some 10 sqrt(a) terms where x is close to a: enough for 1e6 degrees of freedom and more.
constexpr int kMostTerms = 100000;

// ln(a!) less Stirling's formula without its series, for a >= 16: the next term is below 1e-16.
double stirling_rest(double a) {
  const double q = 1.0 / (a * a);
  return (1.0 / 12.0 - q * (1.0 / 360.0 - q * (1.0 / 1260.0 - q * (1.0 / 1680.0 - q / 1188.0)))) / a;
}

// u - 1 - ln u without its cancellation near u = 1.
double deviance(double u) {
  const double d = u - 1.0;
  if (std::abs(d) > 0.1) return d - std::log(u);
  const double v = d / (2.0 + d);  // ln u = 2 (v + v^3/3 + v^5/5 + ...), and d - 2 v = d v
  double sum = 0.0;
  double power = 2.0 * v * v * v;
  for (int n = 3; n < 40; n += 2) {
    sum += power / n;
    power *= v * v;
  }
  return d * v - sum;
}

// x^a e^-x / Gamma(a + 1) (Loader 2000): an exponent made of ln x and ln Gamma would lose a ln(a) epsilon.
double poisson_density(double a, double x) {
  double shift = 1.0;
  for (; a < 16.0; a += 1.0) shift *= (a + 1.0) / x;
  return shift * std::exp(-a * deviance(x / a) - stirling_rest(a)) / std::sqrt(2.0 * std::numbers::pi * a);
}

// P(a, x) over the density: 1 + x/(a+1) + x^2/((a+1)(a+2)) + ...
double lower_series(double a, double x) {
  double term = 1.0;
  double sum = 1.0;
  for (int n = 1; n < kMostTerms && term > 0.25 * kEpsilon * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum;
}

// Gamma(a, x) e^x x^-a = 1/(x+1-a - 1(1-a)/(x+3-a - 2(2-a)/(x+5-a - ...))), by Lentz's method.
double upper_fraction(double a, double x) {
  constexpr double kTiny = 1e-300;
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny;
  double d = 1.0 / b;
  double value = d;
  for (int n = 1; n < kMostTerms; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = b + an * d;
    c = b + an / c;
    d = 1.0 / (d == 0.0 ? kTiny : d);
    c = c == 0.0 ? kTiny : c;
    value *= c * d;
    if (std::abs(c * d - 1.0) < kEpsilon) break;
  }
  return value;
}

}  // namespace

double chi_square_probability(double chi2, double degrees_of_freedom) {
  assert(chi2 >= 0.0 && degrees_of_freedom > 0.0);
  const double a = 0.5 * degrees_of_freedom;
  const double x = 0.5 * chi2;
  if (x == 0.0) return 1.0;
  if (std::isinf(x)) return 0.0;
  const double density = poisson_density(a, x);
  return x < a + 1.0 ? 1.0 - density * lower_series(a, x) : density * a * upper_fraction(a, x);
}

}  // namespace gonio::reflectance
