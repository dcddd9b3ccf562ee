#include "reflectance/integral/polar_sum.h"

#include <cmath>

namespace gonio::reflectance {
namespace {

constexpr std::size_t kSize = DirectionBlock::kSize;

// In pairs: six roundings, whatever the terms.
double folded(DirectionBlock::Row& row) {
  for (std::size_t half = kSize / 2; half > 0; half /= 2) {
    for (std::size_t k = 0; k < half; ++k) row[k] += row[k + half];
  }
  return row[0];
}

}  // namespace

PolarSum::PolarSum(const Surface& surface, const Direction& i, const Direction& axis, double relative_tolerance)
    : surface_(surface), i_(i), axis_(axis), origin_(axis.sin_theta() > 0.0 ? axis.phi() : i.phi()) {
  const FastPath path = surface.fast_path();
  is_fast_ = path.has_kernel && path.relative_error <= 0.1 * relative_tolerance;
  fast_error_ = is_fast_ ? path.relative_error : 0.0;
}

void PolarSum::set_meridian(double cos_psi, double sin_psi) {
  cos_psi_ = cos_psi;
  sin_psi_ = sin_psi;
  rise_ = std::hypot(axis_.mu(), axis_.sin_theta() * cos_psi);
  length_ = std::atan2(axis_.mu(), -axis_.sin_theta() * cos_psi);
}

void PolarSum::flush() {
  DirectionBlock::Row terms;
  place(directions_, terms, nodes_, axis_, origin_);
  BrdfBlock f{};
  if (is_fast_) {
    surface_.eval_fast(i_, directions_, f);
  } else {
    for (std::size_t k = 0; k < count_; ++k) f[k] = surface_.eval(i_, directions_.at(k));
  }
  DirectionBlock::Row sizes;
  for (std::size_t k = 0; k < kSize; ++k) {
    terms[k] = k < count_ ? terms[k] * weights_[k] * in_per_steradian(f[k]) : 0.0;
    sizes[k] = std::abs(terms[k]);
  }
  sum_.add(folded(terms), folded(sizes), fast_error_, count_);
  count_ = 0;
}

RuleSum PolarSum::finished() {
  if (count_ > 0) flush();
  return sum_;
}

}  // namespace gonio::reflectance
