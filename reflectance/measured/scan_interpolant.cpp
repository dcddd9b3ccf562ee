#include "reflectance/measured/scan_interpolant.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "reflectance/table/cross_validation.h"
#include "reflectance/table/table_of_readings.h"

namespace gonio::reflectance {
namespace {

// A thousandth of the guide's mean over the readings.
double floor_under(const Surface& guide, const MeasuredScan& scan, std::span<const std::size_t> usable) {
  double sum = 0.0;
  for (const std::size_t k : usable) sum += std::abs(guide.eval(scan.points[k].geometry).si());
  return 1e-3 * sum / static_cast<double>(usable.size());
}

}  // namespace

Result<ScanInterpolant> ScanInterpolant::make(const MeasuredScan& scan, const Guide& guide, TableOptions options) {
  GONIO_TRY(check(scan));
  options.symmetry = scan.symmetry;
  options.beyond = BeyondReach::Hold;
  options.reciprocal = false;
  const std::vector<std::size_t> usable = usable_points(scan);
  const double floor = floor_under(guide.surface, scan, usable);
  std::vector<TableReading> readings;
  std::vector<std::uint32_t> point;
  std::vector<double> per_guide;
  for (const std::size_t k : usable) {
    const MeasuredPoint& p = scan.points[k];
    const Direction i = incident_direction(p.geometry);
    const Direction r = reflected_direction(p.geometry);
    const double g = guide.surface.eval(i, r).si() + floor;
    if (!(g > 0.0) || !std::isfinite(g)) {
      return failure({.code = ErrorCode::InvalidInput,
                      .tried = fmt::format("interpolate the scan \"{}\" by the guide \"{}\"", scan.name, guide.name),
                      .seen = fmt::format("the guide is {} /sr at point {}", g, k),
                      .limit = "above 0"});
    }
    per_guide.push_back(1.0 / g);
    point.push_back(static_cast<std::uint32_t>(k));
    readings.push_back({.geometry = geometry_of(i, r), .f = {p.value / g, standard_u(p) / g}});
  }
  Result<TabulatedSurface> table = table_of_readings(readings, options);
  if (!table) return failure(std::move(table).error());
  return ScanInterpolant(guide, floor, *std::move(table), std::move(point), std::move(per_guide));
}

ScanInterpolant::ScanInterpolant(Guide guide, double floor, TabulatedSurface table, std::vector<std::uint32_t> point,
                                 std::vector<double> per_guide)
    : guide_(std::move(guide)),
      floor_(floor),
      table_(std::move(table)),
      point_(std::make_shared<const std::vector<std::uint32_t>>(std::move(point))),
      per_guide_(std::make_shared<const std::vector<double>>(std::move(per_guide))) {}

Measured<Brdf> ScanInterpolant::measured(const Direction& i, const Direction& r) const {
  const Measured<Brdf> ratio = table_.measured(i, r);
  const double g = guide_at(i, r);
  return {.value = g * ratio.value, .u = g * ratio.u};
}

bool ScanInterpolant::shares(const Direction& i, const Direction& r, std::vector<ReadingShare>& shares) const {
  const std::size_t first = shares.size();
  const bool is_covered = table_.shares(i, r, shares);
  const double g = guide_at(i, r);
  for (std::size_t k = first; k < shares.size(); ++k) {
    ReadingShare& share = shares[k];
    share.weight *= g * (*per_guide_)[share.reading];
    share.reading = (*point_)[share.reading];
  }
  return is_covered;
}

std::vector<double> ScanInterpolant::cross_validation_errors() const {
  std::vector<double> errors;
  const auto add = [&](const Direction& i, const Direction& r, double ratio, double told) {
    errors.push_back(guide_at(i, r) * (told - ratio));
  };
  visit_view_errors(table_, add);
  visit_incidence_errors(table_, add);
  return errors;
}

}  // namespace gonio::reflectance
