#include "reflectance/measured/measured_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace gonio::reflectance {
namespace {

Error refused(const MeasuredScan& scan, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("use the scan \"{}\"", scan.name),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

Result<void> check_angles(const MeasuredScan& scan, std::size_t k) {
  const Geometry& g = scan.points[k].geometry;
  for (const auto& [name, theta] : {std::pair("theta_i", g.theta_i), std::pair("theta_r", g.theta_r)}) {
    if (std::abs(theta.si()) <= degrees(90.0).si()) continue;
    return failure(refused(scan, fmt::format("point {}: {} {:.12g} deg", k, name, in_degrees(theta)), "-90 to 90 deg"));
  }
  for (const auto& [name, phi] : {std::pair("phi_i", g.phi_i), std::pair("phi_r", g.phi_r)}) {
    if (std::isfinite(phi.si())) continue;
    return failure(refused(scan, fmt::format("point {}: {} {} deg", k, name, in_degrees(phi)), "a finite angle"));
  }
  return {};
}

Result<void> check_numbers(const MeasuredScan& scan, std::size_t k) {
  const MeasuredPoint& p = scan.points[k];
  if (!std::isfinite(p.value.si())) {
    return failure(refused(scan, fmt::format("point {}: value {} /sr", k, p.value.si()), "a finite number"));
  }
  if (!std::isfinite(p.u_random.si()) || p.u_random < Brdf{}) {
    return failure(
        refused(scan, fmt::format("point {}: u_random {} /sr", k, p.u_random.si()), "a finite number, at least 0"));
  }
  for (const SharedEffect& e : p.shared) {
    if (e.component >= scan.components.size()) {
      return failure(refused(scan, fmt::format("point {}: component {}", k, e.component),
                             fmt::format("below {}, the number of components", scan.components.size())));
    }
    if (std::isfinite(e.per_sd.si())) continue;
    return failure(
        refused(scan, fmt::format("point {}: effect of {} {} /sr", k, scan.components[e.component].name, e.per_sd.si()),
                "a finite number"));
  }
  return {};
}

}  // namespace

Result<void> check(const MeasuredScan& scan) {
  if (scan.points.empty()) return failure(refused(scan, "no points", "at least one"));
  const std::vector<std::size_t> usable = usable_points(scan);
  if (usable.empty()) {
    return failure(
        refused(scan, fmt::format("all of its {} points are flagged", scan.points.size()), "at least one to use"));
  }
  for (const std::size_t k : usable) {
    GONIO_TRY(check_angles(scan, k));
    GONIO_TRY(check_numbers(scan, k));
  }
  return {};
}

std::vector<std::size_t> usable_points(const MeasuredScan& scan) {
  std::vector<std::size_t> usable;
  for (std::size_t k = 0; k < scan.points.size(); ++k) {
    if (!scan.points[k].is_flagged) usable.push_back(k);
  }
  return usable;
}

Brdf standard_u(const MeasuredPoint& point) {
  double u2 = point.u_random.si() * point.u_random.si();
  for (const SharedEffect& e : point.shared) u2 += e.per_sd.si() * e.per_sd.si();
  return per_steradian(std::sqrt(u2));
}

MeasuredScan with_unknown_as_random(MeasuredScan scan) {
  for (MeasuredPoint& p : scan.points) {
    double u = p.u_random.si();
    const auto is_unknown = [&](const SharedEffect& e) {
      if (e.component >= scan.components.size() || scan.components[e.component].is_pattern_known) return false;
      u = std::hypot(u, e.per_sd.si());
      return true;
    };
    if (!p.is_flagged) std::erase_if(p.shared, is_unknown);
    p.u_random = per_steradian(u);
  }
  return scan;
}

ScanSymmetryPoints symmetry_points(const MeasuredScan& given) {
  const MeasuredScan scan = with_unknown_as_random(given);
  ScanSymmetryPoints all{.points = {}, .index = usable_points(scan)};
  for (const std::size_t k : all.index) {
    const MeasuredPoint& p = scan.points[k];
    all.points.push_back({.geometry = p.geometry, .value = p.value, .u_random = p.u_random, .shared = p.shared});
  }
  return all;
}

}  // namespace gonio::reflectance
