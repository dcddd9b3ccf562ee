#include "tests/scenario/agreement.h"

#include <cmath>
#include <limits>
#include <set>
#include <vector>

namespace gonio::test {
namespace {

using Matrix = std::vector<std::vector<double>>;

constexpr int kTermsAtMost = 10'000;

// The lower regularised incomplete gamma function, by its series: fast for x < a + 1.
double gamma_p_series(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < kTermsAtMost && std::abs(term) > sum * 1e-16; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

// The upper one, by its continued fraction (Lentz): fast for x > a + 1.
double gamma_q_fraction(double a, double x) {
  double b = x + 1.0 - a;
  double c = 1.0 / std::numeric_limits<double>::min();
  double d = 1.0 / b;
  double fraction = d;
  for (int n = 1; n < kTermsAtMost; ++n) {
    const double numerator = -n * (n - a);
    b += 2.0;
    d = 1.0 / (numerator * d + b);
    c = b + numerator / c;
    fraction *= c * d;
    if (std::abs(c * d - 1.0) < 1e-15) break;
  }
  return fraction * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

// r^T C^-1 r by Cholesky's factor; C is destroyed.
double quadratic_form(Matrix c, std::vector<double> r) {
  const std::size_t n = r.size();
  double sum = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) c[j][j] -= c[j][k] * c[j][k];
    c[j][j] = std::sqrt(c[j][j]);
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) c[i][j] -= c[i][k] * c[j][k];
      c[i][j] /= c[j][j];
    }
    for (std::size_t k = 0; k < j; ++k) r[j] -= c[j][k] * r[k];
    r[j] /= c[j][j];
    sum += r[j] * r[j];
  }
  return sum;
}

double sensitivity(const StoredValue& value, const std::string& component) {
  const auto found = value.shared.find(component);
  return found == value.shared.end() ? 0.0 : found->second;
}

void add_run(const std::map<long, StoredValue>& run, const std::vector<long>& points,
             const std::function<bool(const std::string&)>& is_drawn_anew, Matrix& c) {
  std::set<std::string> components;
  for (const auto& [point, value] : run) {
    for (const auto& [name, part] : value.shared) {
      if (is_drawn_anew(name)) components.insert(name);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const StoredValue& a = run.at(points[i]);
    c[i][i] += a.u_random * a.u_random;
    for (std::size_t j = 0; j < points.size(); ++j) {
      for (const std::string& name : components) c[i][j] += sensitivity(a, name) * sensitivity(run.at(points[j]), name);
    }
  }
}

}  // namespace

double chi_square_tail(double value, long degrees_of_freedom) {
  const double a = 0.5 * static_cast<double>(degrees_of_freedom);
  const double x = 0.5 * value;
  if (x <= 0.0) return 1.0;
  return x < a + 1.0 ? 1.0 - gamma_p_series(a, x) : gamma_q_fraction(a, x);
}

ChiSquare agreement(const std::map<long, StoredValue>& a, const std::map<long, StoredValue>& b,
                    const std::function<bool(const std::string&)>& is_drawn_anew) {
  std::vector<long> points;
  std::vector<double> residuals;
  for (const auto& [point, value] : a) {
    const auto other = b.find(point);
    if (other == b.end()) continue;
    points.push_back(point);
    residuals.push_back(value.value - other->second.value);
  }
  Matrix c(points.size(), std::vector<double>(points.size(), 0.0));
  add_run(a, points, is_drawn_anew, c);
  add_run(b, points, is_drawn_anew, c);
  ChiSquare chi{.value = quadratic_form(std::move(c), std::move(residuals)),
                .degrees_of_freedom = static_cast<long>(points.size())};
  chi.p = chi_square_tail(chi.value, chi.degrees_of_freedom);
  return chi;
}

}  // namespace gonio::test
