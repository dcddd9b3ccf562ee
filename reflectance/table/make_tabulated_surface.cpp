// TabulatedSurface::make: readings are checked, sorted by incidence, merged by direction and laid out as rows.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reflectance/table/merge_readings.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {
namespace {

Error refusal(std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "make a tabulated surface",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

struct AngleRange {
  const char* name;
  Angle value;
  Angle least;
  Angle most;
};

Result<void> check_options(const TableOptions& o) {
  const std::array ranges{
      AngleRange{"same_direction", o.same_direction, degrees(1e-4), degrees(5.0)},
      AngleRange{"widest_cell", o.widest_cell, degrees(0.0), degrees(180.0)},
      AngleRange{"widest_incidence_step", o.widest_incidence_step, degrees(0.0), degrees(180.0)},
  };
  for (const AngleRange& range : ranges) {
    if (range.value >= range.least && range.value <= range.most) continue;
    return failure(refusal(fmt::format("option {} {:.12g} deg", range.name, in_degrees(range.value)),
                           fmt::format("{:g} to {:g} deg", in_degrees(range.least), in_degrees(range.most))));
  }
  return {};
}

Result<void> check_reading(std::size_t k, const TableReading& reading) {
  const Geometry& g = reading.geometry;
  for (const auto& [name, theta] : {std::pair("theta_i", g.theta_i), std::pair("theta_r", g.theta_r)}) {
    if (theta >= Angle{} && theta <= degrees(90.0)) continue;
    return failure(refusal(fmt::format("reading {}: {} {:.12g} deg", k, name, in_degrees(theta)), "0 to 90 deg"));
  }
  for (const auto& [name, phi] : {std::pair("phi_i", g.phi_i), std::pair("phi_r", g.phi_r)}) {
    if (std::isfinite(phi.si())) continue;
    return failure(refusal(fmt::format("reading {}: {} {:.12g} deg", k, name, in_degrees(phi)), "a finite angle"));
  }
  const double f = in_per_steradian(reading.f.value);
  if (!std::isfinite(f)) return failure(refusal(fmt::format("reading {}: value {} /sr", k, f), "a finite number"));
  const double u = in_per_steradian(reading.f.u);
  if (std::isfinite(u) && u >= 0.0) return {};
  return failure(refusal(fmt::format("reading {}: uncertainty {} /sr", k, u), "a finite number, at least 0"));
}

// The readings of one incidence. theta_i and phi_i are those of the first.
struct Group {
  Direction i;
  std::vector<PlacedReading> readings;
};

bool is_same_incidence(const Direction& a, const Direction& b, const TableOptions& options) {
  const bool is_turned_alike = options.symmetry != TableSymmetry::Anisotropic ||
                               a.sin_theta() * std::abs(wrapped(a.phi() - b.phi()).si()) <= options.same_direction.si();
  return std::abs((a.theta() - b.theta()).si()) <= options.same_direction.si() && is_turned_alike;
}

// In the frame of the incidence; an anisotropic surface under normal light has no frame but the sample's.
Vector placed(const Direction& i, const Direction& r, const TableOptions& options) {
  const bool is_normal = i.theta() <= options.same_direction;
  const bool is_absolute = is_normal && options.symmetry == TableSymmetry::Anisotropic;
  const double turn = r.phi().si() - (is_absolute ? 0.0 : i.phi().si());
  const double y = r.sin_theta() * std::sin(turn);
  const bool is_folded = options.symmetry == TableSymmetry::Isotropic;
  return {.x = r.sin_theta() * std::cos(turn), .y = is_folded ? std::abs(y) : y, .z = r.mu()};
}

Result<std::vector<Group>> by_incidence(std::span<const TableReading> readings, const TableOptions& options) {
  constexpr std::size_t kMostIncidences = 4096;
  std::vector<Group> groups;
  std::size_t last = 0;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const TableReading& reading = readings[k];
    const Direction i = incident_direction(reading.geometry);
    const Direction r = reflected_direction(reading.geometry);
    if (last >= groups.size() || !is_same_incidence(groups[last].i, i, options)) {
      const auto known = std::find_if(groups.begin(), groups.end(),
                                      [&](const Group& g) { return is_same_incidence(g.i, i, options); });
      last = static_cast<std::size_t>(known - groups.begin());
      if (known == groups.end()) groups.push_back({.i = i, .readings = {}});
      if (groups.size() > kMostIncidences)
        return failure(
            refusal(fmt::format("{} incidences in the first {} of {} readings", groups.size(), k + 1, readings.size()),
                    fmt::format("{} incidences, with many views each", kMostIncidences)));
    }
    groups[last].readings.push_back(
        {.r = placed(i, r, options), .reading = &reading, .index = static_cast<std::uint32_t>(k)});
  }
  return groups;
}

Result<TableRow> row_of(const Group& group, const TableOptions& options, TableReport& report) {
  const double tolerance = options.same_direction.si();
  MergedNodes nodes = merged_nodes(group.readings, tolerance, report);
  report.directions += nodes.nodes.size();
  RowAzimuths azimuths = RowAzimuths::Full;
  if (options.symmetry == TableSymmetry::Isotropic) azimuths = RowAzimuths::Folded;
  if (options.symmetry != TableSymmetry::Anisotropic && group.i.theta() <= options.same_direction) {
    azimuths = RowAzimuths::None;
    nodes = profile_nodes(nodes, tolerance);
  }
  Result<TableRow> row = TableRow::make(group.i.theta(), group.i.phi(), std::move(nodes), azimuths, options);
  if (row) return row;
  Error error = std::move(row).error();
  error.tried =
      fmt::format("make a tabulated surface of scattered directions at theta_i {:.12g} deg, phi_i {:.12g} deg",
                  in_degrees(group.i.theta()), in_degrees(group.i.phi()));
  error.limit += "; readings in one plane are laid out as rings";
  return failure(std::move(error));
}

}  // namespace

Result<TabulatedSurface> TabulatedSurface::make(std::span<const TableReading> readings, const TableOptions& options) {
  GONIO_TRY(check_options(options));
  for (std::size_t k = 0; k < readings.size(); ++k) GONIO_TRY(check_reading(k, readings[k]));
  TableReport report{.readings = readings.size()};
  std::vector<TableRow> rows;
  const Result<std::vector<Group>> groups = by_incidence(readings, options);
  if (!groups) return failure(groups.error());
  for (const Group& group : *groups) {
    Result<TableRow> row = row_of(group, options, report);
    if (!row) return failure(std::move(row).error());
    rows.push_back(std::move(*row));
  }
  report.incidences = rows.size();
  if (report.directions < 2) {
    return failure(refusal(fmt::format("{} readings of {} directions", report.readings, report.directions),
                           "at least two directions"));
  }
  return TabulatedSurface(std::move(rows), options, std::move(report));
}

}  // namespace gonio::reflectance
