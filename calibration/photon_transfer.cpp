#include "calibration/photon_transfer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace gonio::calibration {
namespace {

Error refusal(ErrorCode code, std::string tried, std::string seen, std::string limit) {
  return {.code = code,
          .device = "detector",
          .tried = std::move(tried),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

/// variance = intercept + slope x, x the mean above the dark one.
struct Line {
  double intercept = 0.0;
  double slope = 0.0;
  double u_intercept = 0.0;
  double u_slope = 0.0;
};

// JCGM 100:2008, H.3 with weights; `at` gives the variance that each pair's weight goes by.
template <class VarianceAt>
Line fit(const FramePair& dark, const std::vector<FramePair>& lit, VarianceAt at) {
  double w0 = 0.0, wx = 0.0, wxx = 0.0, wy = 0.0, wxy = 0.0;
  const auto add = [&](const FramePair& pair) {
    const double x = pair.mean_dn - dark.mean_dn;
    const double weight = pair.n / (2.0 * std::pow(at(pair, x), 2));
    w0 += weight;
    wx += weight * x;
    wxx += weight * x * x;
    wy += weight * pair.variance_dn2;
    wxy += weight * x * pair.variance_dn2;
  };
  add(dark);
  for (const FramePair& pair : lit) add(pair);
  const double determinant = w0 * wxx - wx * wx;
  return {.intercept = (wxx * wy - wx * wxy) / determinant,
          .slope = (w0 * wxy - wx * wy) / determinant,
          .u_intercept = std::sqrt(wxx / determinant),
          .u_slope = std::sqrt(w0 / determinant)};
}

}  // namespace

Result<FramePair> pair_of(std::span<const std::uint16_t> first, std::span<const std::uint16_t> second) {
  if (first.size() != second.size() || first.size() < 2) {
    return failure(refusal(ErrorCode::IncompleteData, "compare two frames",
                           fmt::format("{} and {} pixels", first.size(), second.size()), "as many, two at least"));
  }
  std::int64_t both = 0, difference = 0, difference2 = 0;  // 2^31 pixels would overflow the last
  for (std::size_t k = 0; k < first.size(); ++k) {
    const std::int64_t d = std::int64_t{first[k]} - second[k];
    both += std::int64_t{first[k]} + second[k];
    difference += d;
    difference2 += d * d;
  }
  const auto n = static_cast<double>(first.size());
  const double mean_difference = static_cast<double>(difference) / n;
  const double square = static_cast<double>(difference2) / n - mean_difference * mean_difference;
  return FramePair{.mean_dn = static_cast<double>(both) / (2.0 * n),
                   .variance_dn2 = 0.5 * square * n / (n - 1.0),
                   .n = static_cast<std::uint32_t>(first.size())};
}

Result<PhotonTransfer> photon_transfer(const FramePair& dark, const std::vector<FramePair>& lit) {
  constexpr int kRounds = 5;       // the weights settle after two
  constexpr double kLeast = 1e-6;  // DN^2: rounding alone leaves 1/12
  const std::string tried = "estimate photon transfer";
  bool has_light = false;
  for (const FramePair& pair : lit) has_light = has_light || pair.mean_dn > dark.mean_dn;
  if (!has_light || dark.n == 0) {
    return failure(refusal(ErrorCode::IncompleteData, tried, fmt::format("{} lit pairs", lit.size()),
                           "at least one brighter than the dark"));
  }
  Line line = fit(dark, lit, [&](const FramePair& pair, double) { return std::max(kLeast, pair.variance_dn2); });
  for (int round = 0; round < kRounds; ++round) {
    const Line before = line;
    line = fit(dark, lit,
               [&](const FramePair&, double x) { return std::max(kLeast, before.intercept + before.slope * x); });
  }
  if (!(line.slope > 0.0) || !(line.intercept >= 0.0)) {
    return failure(refusal(ErrorCode::OutOfLimits, tried,
                           fmt::format("variance {:.4g} DN^2 + {:.4g} DN^2 for each DN", line.intercept, line.slope),
                           "both above 0"));
  }
  const double read = std::sqrt(line.intercept);
  return PhotonTransfer{
      .electrons_per_dn = {.value = 1.0 / line.slope, .u = line.u_slope / (line.slope * line.slope)},
      .read_noise_dn = {.value = read,
                        .u = read > 0.0 ? line.u_intercept / (2.0 * read) : std::sqrt(line.u_intercept)}};
}

}  // namespace gonio::calibration
