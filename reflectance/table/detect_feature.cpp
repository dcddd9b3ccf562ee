#include "reflectance/table/detect_feature.h"

#include <cmath>
#include <optional>

namespace gonio::reflectance {
namespace {

struct Brightness {
  double near = 0.0;
  double far = 0.0;
};

std::optional<Brightness> brightness_about(const TableRow& row, const Vector& axis) {
  const double near_limit = degrees(10.0).si();
  const double far_first = degrees(15.0).si();
  const double far_last = degrees(35.0).si();
  Brightness mean;
  int near_count = 0;
  int far_count = 0;
  for (const TableNode& node : row.nodes()) {
    const double xi = arc(node.r, axis);
    if (xi <= near_limit) {
      mean.near += node.f;
      ++near_count;
    } else if (xi >= far_first && xi <= far_last) {
      mean.far += node.f;
      ++far_count;
    }
  }
  if (near_count == 0 || far_count == 0) return std::nullopt;
  mean.near /= near_count;
  mean.far /= far_count;
  return mean;
}

// Over the incidences from 10 deg on; `side` 1 for the retro direction, -1 for the mirror's.
Brightness brightness(std::span<const TableRow> rows, double side) {
  Brightness sum;
  for (const TableRow& row : rows) {
    if (row.theta_i() < degrees(10.0)) continue;
    const IncidenceTilt& tilt = row.tilt();
    if (const auto one = brightness_about(row, {.x = side * tilt.sin_theta, .y = 0.0, .z = tilt.mu})) {
      sum.near += one->near;
      sum.far += one->far;
    }
  }
  return sum;
}

bool stands_out(const Brightness& b) {
  return b.near - b.far > 0.05 * (std::abs(b.near) + std::abs(b.far));
}

}  // namespace

DetectedFeature detected_feature(std::span<const TableRow> rows) {
  const Brightness retro = brightness(rows, 1.0);
  const Brightness mirror = brightness(rows, -1.0);
  const bool has_retro = stands_out(retro);
  const bool has_mirror = stands_out(mirror);
  if (!has_retro && !has_mirror) return {};
  const bool is_retro = has_retro && (!has_mirror || retro.near - retro.far >= mirror.near - mirror.far);
  return {.feature = is_retro ? Feature::HotSpot : Feature::Lobe, .is_double = has_retro && has_mirror};
}

}  // namespace gonio::reflectance
