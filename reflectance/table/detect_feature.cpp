#include "reflectance/table/detect_feature.h"

#include <cmath>
#include <optional>

namespace gonio::reflectance {
namespace {

std::optional<double> contrast_about(const TableRow& row, const Vector& axis) {
  const double near_limit = degrees(10.0).si();
  const double far_first = degrees(15.0).si();
  const double far_last = degrees(35.0).si();
  double near = 0.0;
  double far = 0.0;
  int near_count = 0;
  int far_count = 0;
  for (const TableNode& node : row.nodes()) {
    const double xi = arc(node.r, axis);
    if (xi <= near_limit) {
      near += node.f;
      ++near_count;
    } else if (xi >= far_first && xi <= far_last) {
      far += node.f;
      ++far_count;
    }
  }
  if (near_count == 0 || far_count == 0) return std::nullopt;
  near /= near_count;
  far /= far_count;
  const double size = std::abs(near) + std::abs(far);
  return size > 0.0 ? std::optional((near - far) / size) : std::nullopt;
}

}  // namespace

Feature detected_feature(std::span<const TableRow> rows) {
  constexpr double kStandsOut = 0.05;
  double retro = 0.0;
  double mirror = 0.0;
  int retro_rows = 0;
  int mirror_rows = 0;
  for (const TableRow& row : rows) {
    if (row.theta_i() < degrees(10.0)) continue;
    const IncidenceTilt& tilt = row.tilt();
    if (const auto c = contrast_about(row, {.x = tilt.sin_theta, .y = 0.0, .z = tilt.mu})) {
      retro += *c;
      ++retro_rows;
    }
    if (const auto c = contrast_about(row, {.x = -tilt.sin_theta, .y = 0.0, .z = tilt.mu})) {
      mirror += *c;
      ++mirror_rows;
    }
  }
  if (retro_rows > 0) retro /= retro_rows;
  if (mirror_rows > 0) mirror /= mirror_rows;
  if (std::max(retro, mirror) <= kStandsOut) return Feature::Smooth;
  return retro >= mirror ? Feature::HotSpot : Feature::Lobe;
}

}  // namespace gonio::reflectance
