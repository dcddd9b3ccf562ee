// How far each kernel may be from `eval`, in units of 2^-53: the sum of what both round, larger than the worst that
// tests/reflectance/batch found in 1e6 pairs each by a factor of 1.2 to 10.
#include <algorithm>
#include <cmath>

#include "reflectance/surface/glint.h"
#include "reflectance/surface/hapke.h"
#include "reflectance/surface/minnaert.h"
#include "reflectance/surface/rpv.h"
#include "reflectance/surface/surface_sum.h"

namespace gonio::reflectance {
namespace {

constexpr double kUnit = 0x1p-53;

}  // namespace

FastPath Minnaert::fast_path() const {
  return {.has_kernel = true, .relative_error = (6.0 + 1.5 * std::abs(p_.k)) * kUnit};
}

FastPath Rpv::fast_path() const {
  return {.has_kernel = true, .relative_error = 24.0 * kUnit};
}

FastPath Hapke::fast_path() const {
  if (p_.g == 0.0) return {.has_kernel = true, .relative_error = exact_ ? 10.0 * kUnit : 0.0};
  return {.has_kernel = true, .relative_error = 20.0 * kUnit};
}

FastPath Glint::fast_path() const {
  // What depth rounds is multiplied by it in the exponential; below e^-kDeepest what `eval` has is left out.
  return {
      .has_kernel = true, .relative_error = (40.0 + 10.0 * kDeepest) * kUnit, .absolute_error = per_steradian(1e-260)};
}

FastPath SurfaceSum::fast_path() const {
  FastPath sum;
  for (const SurfaceTerm& term : terms_) {
    const FastPath part = term.surface.fast_path();
    sum.has_kernel = sum.has_kernel || part.has_kernel;
    sum.relative_error = std::max(sum.relative_error, part.relative_error);
    sum.absolute_error += term.weight * part.absolute_error;
  }
  // Terms of the same bits are added in the same order.
  if (sum.relative_error > 0.0) sum.relative_error += 2.0 * static_cast<double>(terms_.size()) * kUnit;
  return sum;
}

}  // namespace gonio::reflectance
