#include "reflectance/light/table_sky.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "reflectance/light/brightness.h"

namespace gonio::reflectance {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kHorizon = 0.5 * std::numbers::pi;

Error bad_table(std::string field, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "make a sky from a table",
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{.file = {}, .field = std::move(field)}};
}

// First index whose angle is not finite or not above the one before it, or the size.
std::size_t first_out_of_order(std::span<const Angle> angles) {
  for (std::size_t k = 0; k < angles.size(); ++k) {
    if (!std::isfinite(angles[k].si()) || (k > 0 && angles[k] <= angles[k - 1])) return k;
  }
  return angles.size();
}

Result<void> check_axis(std::string_view name, std::span<const Angle> angles) {
  const std::size_t k = first_out_of_order(angles);
  if (k == angles.size()) return {};
  return failure(bad_table(std::string(name), fmt::format("{} {} is {} deg", name, k + 1, in_degrees(angles[k])),
                           "finite, ascending"));
}

Result<void> check_radiances(std::size_t columns, std::span<const double> radiances) {
  const auto bad = std::ranges::find_if_not(radiances, is_brightness);
  if (bad == radiances.end()) return {};
  const auto k = static_cast<std::size_t>(bad - radiances.begin());
  return failure(bad_table("radiances",
                           fmt::format("radiance {} in row {}, column {}", *bad, k / columns + 1, k % columns + 1),
                           "finite, at least 0"));
}

}  // namespace

struct TableSky::Place {
  std::size_t low;
  std::size_t high;
  double part;  // of the way from low to high
};

Result<TableSky> TableSky::make(std::vector<Angle> thetas, std::vector<Angle> phis, std::span<const double> radiances) {
  constexpr double kRounding = 1e-12;  // [rad] of 90 deg from degrees
  GONIO_TRY(check_axis("theta", thetas));
  GONIO_TRY(check_axis("phi", phis));
  if (thetas.size() < 2 || thetas.front() != Angle{} || std::abs(thetas.back().si() - kHorizon) > kRounding) {
    return failure(
        bad_table("thetas",
                  fmt::format("{} rows, {} to {} deg", thetas.size(), thetas.empty() ? 0.0 : in_degrees(thetas.front()),
                              thetas.empty() ? 0.0 : in_degrees(thetas.back())),
                  "from 0 to 90 deg"));
  }
  if (phis.empty() || (phis.back() - phis.front()).si() > kTurn - kRounding) {
    return failure(bad_table(
        "phis",
        fmt::format("{} columns over {} deg", phis.size(), phis.empty() ? 0.0 : in_degrees(phis.back() - phis.front())),
        "at least one, less than a turn (the first closes it)"));
  }
  if (radiances.size() != thetas.size() * phis.size()) {
    return failure(bad_table("radiances", fmt::format("{} radiances", radiances.size()),
                             fmt::format("{} rows of {}", thetas.size(), phis.size())));
  }
  GONIO_TRY(check_radiances(phis.size(), radiances));
  thetas.back() = radians(kHorizon);
  return TableSky(std::move(thetas), std::move(phis), radiances);
}

TableSky::TableSky(std::vector<Angle> thetas, std::vector<Angle> phis, std::span<const double> radiances)
    : thetas_(std::move(thetas)), phis_(std::move(phis)), radiances_(radiances.begin(), radiances.end()) {
  const std::size_t columns = phis_.size();
  const double pole =
      std::accumulate(radiances_.begin(), radiances_.begin() + static_cast<std::ptrdiff_t>(columns), 0.0) /
      static_cast<double>(columns);
  std::fill_n(radiances_.begin(), columns, pole);
  for (std::size_t row = 0; row < thetas_.size(); ++row) {
    double sum = 0.0;
    for (std::size_t k = 0; k < columns; ++k) {
      const Angle next = k + 1 < columns ? phis_[k + 1] : phis_[0] + radians(kTurn);
      const Angle before = k > 0 ? phis_[k - 1] : phis_[columns - 1] - radians(kTurn);
      sum += radiances_[row * columns + k] * 0.5 * (next - before).si();
    }
    ring_means_.push_back(sum / kTurn);
  }
}

TableSky::Place TableSky::theta_place(Angle theta) const {
  const auto above = std::upper_bound(thetas_.begin() + 1, thetas_.end() - 1, theta);
  const auto high = static_cast<std::size_t>(above - thetas_.begin());
  const double part = (theta - thetas_[high - 1]) / (thetas_[high] - thetas_[high - 1]);
  return {.low = high - 1, .high = high, .part = std::clamp(part, 0.0, 1.0)};
}

TableSky::Place TableSky::phi_place(Angle phi) const {
  const std::size_t last = phis_.size() - 1;
  const double turned = std::fmod((phi - phis_[0]).si(), kTurn);
  const Angle within = phis_[0] + radians(turned < 0.0 ? turned + kTurn : turned);
  if (within >= phis_[last]) {
    const double gap = (phis_[0] - phis_[last]).si() + kTurn;
    return {.low = last, .high = 0, .part = (within - phis_[last]).si() / gap};
  }
  const auto high = static_cast<std::size_t>(std::ranges::upper_bound(phis_, within) - phis_.begin());
  return {.low = high - 1, .high = high, .part = (within - phis_[high - 1]) / (phis_[high] - phis_[high - 1])};
}

double TableSky::at(std::size_t row, const Place& phi) const {
  const double* values = radiances_.data() + row * phis_.size();
  return (1.0 - phi.part) * values[phi.low] + phi.part * values[phi.high];
}

double TableSky::radiance(const Direction& i) const {
  const Place theta = theta_place(i.theta());
  const Place phi = phi_place(i.phi());
  return (1.0 - theta.part) * at(theta.low, phi) + theta.part * at(theta.high, phi);
}

double TableSky::ring_mean(const Direction& i) const {
  const Place theta = theta_place(i.theta());
  return (1.0 - theta.part) * ring_means_[theta.low] + theta.part * ring_means_[theta.high];
}

std::vector<Angle> TableSky::theta_breaks() const {
  return {thetas_.begin() + 1, thetas_.end() - 1};
}

}  // namespace gonio::reflectance
