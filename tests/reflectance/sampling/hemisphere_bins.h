#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "reflectance/integral/gauss_legendre.h"
#include "reflectance/sampling/sample_batch.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// What a chi-square test says: the probability of a larger value if the sampler is right.
struct ChiSquare {
  double value = 0.0;
  double freedom = 0.0;
  double p = 0.0;
};

/// Q(a, x) of the gamma distribution: series below the mean, Lentz's continued fraction above it.
inline double upper_gamma_share(double a, double x) {
  if (x <= 0.0) return 1.0;
  const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a;
    double sum = term;
    for (int n = 1; n < 100000 && term > 1e-17 * sum; ++n) {
      term *= x / (a + n);
      sum += term;
    }
    return 1.0 - scale * sum;
  }
  double b = x + 1.0 - a;
  double c = 1e300;
  double d = 1.0 / b;
  double h = d;
  for (int n = 1; n < 100000; ++n) {
    b += 2.0;
    const double factor = -n * (n - a);
    d = 1.0 / (factor * d + b);
    c = b + factor / c;
    h *= c * d;
    if (std::abs(c * d - 1.0) < 1e-16) break;
  }
  return scale * h;
}

/// Weighted counts of drawn directions in a net of the hemisphere (rows of sqrt(mu); columns of equal steps of the
/// azimuth's diamond angle), the mirror part in a bin of its own, beside what each should hold: the integral of f mu
/// over the bin, by Gauss points of its own that are halved until they agree.
class HemisphereBins {
 public:
  HemisphereBins(const Surface& surface, const Direction& i) : surface_(surface), i_(i), bins_(kRows * kColumns + 1) {
    for (std::size_t row = 0; row < kRows; ++row) {
      for (std::size_t column = 0; column < kColumns; ++column) {
        Patch patch{.v = edge(row, kRows), .w = edge(column, kColumns)};
        patch.dv = edge(row + 1, kRows) - patch.v;
        patch.dw = edge(column + 1, kColumns) - patch.w;
        bins_[row * kColumns + column].expected = refined(patch, gauss(patch), 0);
      }
    }
    bins_.back().expected = surface.specular(i);
    for (const Bin& bin : bins_) total_ += bin.expected;
  }

  void add(const SampleBatch& batch) {
    for (std::size_t n = 0; n < batch.size(); ++n)
      add(batch.x[n], batch.y[n], batch.z[n], batch.weight[n], batch.is_specular[n]);
  }

  void add(double x, double y, double z, double weight, bool is_specular) {
    Bin& bin = is_specular ? bins_.back() : bins_[place(x, y, z)];
    bin.sum += weight;
    bin.square += weight * weight;
    ++draws_;
  }

  /// rho_dh by the bins' own integrals.
  [[nodiscard]] double total() const { return total_; }
  [[nodiscard]] double mean_weight() const { return summed().sum / draws_; }
  /// Standard deviation of the mean weight.
  [[nodiscard]] double mean_deviation() const {
    const double mean = mean_weight();
    return std::sqrt(std::max(0.0, summed().square / draws_ - mean * mean) / draws_);
  }

  /// Sum of (weight found - weight expected)^2 / sum of weight^2. Of the weights' covariance, N (E[w^2] in the bin on
  /// the diagonal - the product of both bins' shares), the second part takes s = sum of share^2 / E[w^2] from the
  /// degrees of freedom: one where all weights are alike. Bins of less than 50 expected draws are taken together.
  [[nodiscard]] ChiSquare chi_square() const {
    ChiSquare result;
    Bin rest;
    for (const Bin& bin : bins_) {
      if (bin.expected * draws_ >= 50.0 * total_) {
        count(bin, result);
      } else {
        rest.expected += bin.expected;
        rest.sum += bin.sum;
        rest.square += bin.square;
      }
    }
    if (rest.expected * draws_ >= 20.0 * total_) count(rest, result);
    result.p = upper_gamma_share(0.5 * result.freedom, 0.5 * result.value);
    return result;
  }

 private:
  static constexpr std::size_t kRows = 20;
  static constexpr std::size_t kColumns = 24;

  struct Bin {
    double expected = 0.0;
    double sum = 0.0;
    double square = 0.0;
  };
  struct Patch {
    double v = 0.0;
    double w = 0.0;
    double dv = 0.0;
    double dw = 0.0;
  };

  static double edge(std::size_t k, std::size_t count) { return static_cast<double>(k) / static_cast<double>(count); }

  // 0 to 4 around the circle: on each side of the diamond |x| + |y| = 1 the way along it.
  static double diamond(double x, double y) {
    const double size = std::abs(x) + std::abs(y);
    if (size == 0.0) return 0.0;
    const double t = y / size;
    return x < 0.0 ? 2.0 - t : (y < 0.0 ? 4.0 + t : t);
  }
  static std::size_t place(double x, double y, double z) {
    const auto row = std::min(static_cast<std::size_t>(std::sqrt(z) * kRows), kRows - 1);
    const auto column = std::min(static_cast<std::size_t>(0.25 * diamond(x, y) * kColumns), kColumns - 1);
    return row * kColumns + column;
  }

  // f mu dOmega per dv dw, w the diamond angle over 4: phi follows it by tan(phi) = t / (1 - t) within a quarter.
  [[nodiscard]] double density(double v, double w) const {
    const double quarter = std::floor(4.0 * w);
    const double t = 4.0 * w - quarter;
    const double phi = 0.5 * std::numbers::pi * quarter + std::atan2(t, 1.0 - t);
    const double turning = 4.0 / (t * t + (1.0 - t) * (1.0 - t));
    const double mu = v * v;
    const Direction r = Direction::from_cosine(mu, std::sqrt((1.0 - mu) * (1.0 + mu)), radians(phi));
    return in_per_steradian(surface_.eval(i_, r)) * mu * 2.0 * v * turning;
  }

  [[nodiscard]] double gauss(const Patch& patch) const {
    static const UnitRule rule = gauss_legendre(6);
    double sum = 0.0;
    for (std::size_t a = 0; a < rule.nodes.size(); ++a) {
      for (std::size_t b = 0; b < rule.nodes.size(); ++b) {
        sum += rule.weights[a] * rule.weights[b] *
               density(patch.v + patch.dv * rule.nodes[a], patch.w + patch.dw * rule.nodes[b]);
      }
    }
    return sum * patch.dv * patch.dw;
  }

  [[nodiscard]] double refined(const Patch& patch, double coarse, int depth) const {
    const double dv = 0.5 * patch.dv;
    const double dw = 0.5 * patch.dw;
    const Patch parts[] = {{patch.v, patch.w, dv, dw},
                           {patch.v + dv, patch.w, dv, dw},
                           {patch.v, patch.w + dw, dv, dw},
                           {patch.v + dv, patch.w + dw, dv, dw}};
    double values[4];
    double fine = 0.0;
    for (int k = 0; k < 4; ++k) fine += values[k] = gauss(parts[k]);
    const bool agrees = std::abs(fine - coarse) <= 1e-6 * std::abs(fine) + 1e-12;
    if ((agrees && depth >= 1) || depth >= 12) return fine;
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) sum += refined(parts[k], values[k], depth + 1);
    return sum;
  }

  void count(const Bin& bin, ChiSquare& result) const {
    const double expected = draws_ * bin.expected;
    const double square = bin.square > 0.0 ? bin.square : expected * total_;
    result.value += (bin.sum - expected) * (bin.sum - expected) / square;
    result.freedom += 1.0 - expected * bin.expected / square;
  }

  [[nodiscard]] Bin summed() const {
    Bin all;
    for (const Bin& bin : bins_) {
      all.sum += bin.sum;
      all.square += bin.square;
    }
    return all;
  }

  Surface surface_;
  Direction i_;
  std::vector<Bin> bins_;
  double draws_ = 0.0;
  double total_ = 0.0;
};

}  // namespace gonio::reflectance
