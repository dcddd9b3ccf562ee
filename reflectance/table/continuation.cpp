#include "reflectance/table/continuation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace gonio::reflectance {
namespace {

constexpr std::size_t kSize = 6;
using Terms = std::array<double, kSize>;

double dot(const Terms& a, const Terms& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// Solves a x = b in place by Cholesky's factors; a is positive definite, its lower half is read.
Terms solved(std::array<Terms, kSize> a, Terms b) {
  for (std::size_t j = 0; j < kSize; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    a[j][j] = std::sqrt(a[j][j]);
    for (std::size_t i = j + 1; i < kSize; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t j = 0; j < kSize; ++j) {
    for (std::size_t k = 0; k < j; ++k) b[j] -= a[j][k] * b[k];
    b[j] /= a[j][j];
  }
  for (std::size_t j = kSize; j-- > 0;) {
    for (std::size_t k = j + 1; k < kSize; ++k) b[j] -= a[k][j] * b[k];
    b[j] /= a[j][j];
  }
  return b;
}

// By the normal equations. What the directions cannot tell apart (a term that is 0 in one plane) is kept at 0 by a
// ridge far below what they can.
Terms least_squares(std::span<const Terms> rows, std::span<const double> f, std::span<const double> weight) {
  constexpr double kRidge = 1e-9;
  std::array<Terms, kSize> a{};
  Terms b{};
  double size = 0.0;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    for (std::size_t j = 0; j < kSize; ++j) {
      b[j] += weight[n] * rows[n][j] * f[n];
      for (std::size_t k = 0; k <= j; ++k) a[j][k] += weight[n] * rows[n][j] * rows[n][k];
    }
    size += weight[n];
  }
  for (std::size_t j = 0; j < kSize; ++j) a[j][j] += kRidge * size;
  return solved(a, b);
}

}  // namespace

std::array<double, Continuation::kTerms> Continuation::terms(const Vector& r) {
  return {1.0, r.z, r.x, r.y, r.x * r.z, r.y * r.z};
}

Continuation::Continuation(std::span<const TableNode> nodes) {
  constexpr double kBand = 0.7;  // 40 deg
  const auto theta = [](const TableNode& n) { return std::atan2(std::hypot(n.r.x, n.r.y), n.r.z); };
  double outermost = 0.0;
  for (const TableNode& n : nodes) outermost = std::max(outermost, theta(n));
  std::vector<Terms> rows;
  std::vector<double> f;
  for (const TableNode& n : nodes) {
    if (theta(n) < outermost - kBand) continue;
    rows.push_back(terms(n.r));
    f.push_back(n.f);
  }
  if (rows.size() < kTerms) return;
  // Least absolute deviations by least squares, each time with weights from the time before.
  constexpr int kTimes = 12;
  std::vector<double> weight(rows.size(), 1.0);
  for (int time = 0; time < kTimes; ++time) {
    coefficient_ = least_squares(rows, f, weight);
    double mean = 0.0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      weight[k] = std::abs(dot(coefficient_, rows[k]) - f[k]);
      mean += weight[k] / static_cast<double>(rows.size());
    }
    if (mean == 0.0) return;
    for (double& w : weight) w = mean / std::max(w, 1e-3 * mean);
  }
}

double Continuation::operator()(const Vector& r) const {
  return dot(coefficient_, terms(r));
}

}  // namespace gonio::reflectance
