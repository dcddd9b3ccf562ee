#include "reflectance/fit/scan_whitening.h"

#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace gonio::fit {
namespace {

constexpr std::size_t kMostComponents = 2048;

std::vector<std::uint32_t> components_of(std::span<const ReadingError> errors) {
  std::set<std::uint32_t> all;
  for (const ReadingError& error : errors) {
    for (const auto& entry : error.shared.entries()) all.insert(entry.component);
  }
  return {all.begin(), all.end()};
}

}  // namespace

Result<ScanWhitening> ScanWhitening::make(std::span<const ReadingError> errors) {
  std::vector<std::uint32_t> components = components_of(errors);
  if (components.size() > kMostComponents) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "weight the readings of a scan",
                    .seen = fmt::format("{} shared components", components.size()),
                    .limit = fmt::format("at most {}", kMostComponents)});
  }
  return ScanWhitening(errors, std::move(components));
}

ScanWhitening::ScanWhitening(std::span<const ReadingError> errors, std::vector<std::uint32_t> components)
    : components_(std::move(components)), first_{0}, solver_(SquareMatrix(0)) {
  for (const ReadingError& error : errors) {
    assert(error.u_random > 0.0);
    u_random_.push_back(error.u_random);
    for (const auto& entry : error.shared.entries()) {
      const auto place = std::ranges::lower_bound(components_, entry.component) - components_.begin();
      effects_.push_back({.place = static_cast<std::uint32_t>(place), .size = entry.per_sd / error.u_random});
    }
    first_.push_back(effects_.size());
  }
  solver_ = PositiveSolver(normal_matrix());
}

// 1 + A^T A, its lower triangle: the effects of a reading ascend.
SquareMatrix ScanWhitening::normal_matrix() const {
  SquareMatrix matrix(components_.size());
  for (std::size_t k = 0; k < components_.size(); ++k) matrix.at(k, k) = 1.0;
  for (std::size_t j = 0; j < readings(); ++j) {
    const std::span<const Effect> own = effects(j);
    for (std::size_t a = 0; a < own.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) matrix.at(own[a].place, own[b].place) += own[a].size * own[b].size;
    }
  }
  return matrix;
}

void ScanWhitening::whiten(std::span<const double> x, std::span<double> z) const {
  assert(x.size() == readings() && z.size() == size());
  const std::span<double> e = z.subspan(readings());
  std::ranges::fill(e, 0.0);
  for (std::size_t j = 0; j < readings(); ++j) {
    z[j] = x[j] / u_random_[j];
    for (const Effect& effect : effects(j)) e[effect.place] += effect.size * z[j];
  }
  solver_.solve(e);
  for (std::size_t j = 0; j < readings(); ++j) {
    for (const Effect& effect : effects(j)) z[j] -= effect.size * e[effect.place];
  }
}

}  // namespace gonio::fit
