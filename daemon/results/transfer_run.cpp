#include "daemon/results/transfer_run.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <vector>

#include "daemon/results/brdf_means.h"

namespace gonio::daemon {
namespace {

bool is_at_zero_forty_five(const Geometry& planned) {
  constexpr Angle kWithin = degrees(1e-3);
  constexpr bool kIsotropic = true;
  return same_geometry(planned, {.theta_i = {}, .phi_i = {}, .theta_r = degrees(45.0), .phi_r = {}}, kIsotropic,
                       kWithin);
}

}  // namespace

Result<calibration::FoundValues> transfer_of(const NewBrdf& brdf, const calibration::ScanReadings& readings,
                                             const std::string& master) {
  std::map<std::int32_t, const calibration::PlannedPoint*> planned;
  std::map<std::int64_t, std::vector<std::size_t>> at_wavelength;  // by pm: places in the rows
  for (const calibration::PlannedPoint& point : readings.points) {
    planned[point.index] = &point;
    at_wavelength[std::llround(1e3 * in_nanometres(point.wavelength))];
  }
  for (std::size_t k = 0; k < brdf.rows.size(); ++k) {
    const auto point = planned.find(brdf.rows[k].point);
    if (point == planned.end() || !is_at_zero_forty_five(point->second->geometry)) continue;
    at_wavelength[std::llround(1e3 * in_nanometres(point->second->wavelength))].push_back(k);
  }
  calibration::FoundValues found;
  std::vector<std::vector<std::size_t>> groups;
  std::size_t points = 0;
  for (const auto& [picometres, rows] : at_wavelength) {
    const double nm = 1e-3 * static_cast<double>(picometres);
    if (rows.empty()) {
      return failure(Error{.code = ErrorCode::IncompleteData,
                           .device = "working standard",
                           .tried = fmt::format("take its reflectance factor at {:g} nm from {}", nm, master),
                           .seen = "no value at 0/45",
                           .limit = "theta_i 0, theta_r 45 deg in the plan, at each wavelength"});
    }
    found.values.push_back({.name = fmt::format("reff_0_45_{:.7g}nm", nm), .unit = "1", .value = 0.0});
    groups.push_back(rows);
    points += rows.size();
  }
  const BrdfMeans means = means_of(brdf, groups);
  for (std::size_t k = 0; k < groups.size(); ++k) found.values[k].value = means.values[k];
  found.covariance = means.covariance;
  found.note = fmt::format("from {}, {} points at 0/45", master, points);
  return found;
}

}  // namespace gonio::daemon
