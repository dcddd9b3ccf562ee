// Points of one geometry, and check visits of the sample.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "calibration/checks/check_parts.h"

namespace gonio::calibration {
namespace {

using Group = std::vector<reflectance::GroupMember>;
// Planned directions and wavelength: of an isotropic sample turned ones are the same.
using PlannedPlace = std::array<std::int64_t, 5>;

PlannedPlace planned_place(const PlannedPoint& point, bool isotropic) {
  const auto key = [](Angle a) { return std::llround(in_degrees(a) * 1e3); };
  const Geometry& g = point.geometry;
  const std::int64_t wavelength = std::llround(in_nanometres(point.wavelength) * 1e3);
  if (!isotropic) return {wavelength, key(g.theta_i), key(g.theta_r), key(wrapped(g.phi_i)), key(wrapped(g.phi_r))};
  const bool at_pole = key(g.theta_i) == 0 || key(g.theta_r) == 0;
  return {wavelength, key(g.theta_i), key(g.theta_r), 0, at_pole ? 0 : key(wrapped(g.phi_r - g.phi_i))};
}

double z_between(const reflectance::GroupMember& a, const reflectance::GroupMember& b) {
  reflectance::SharedEffects difference = a.shared;
  difference.add(b.shared, -1.0);
  return (b.value - a.value) / std::hypot(std::hypot(a.u_random, b.u_random), size_of(difference));
}

class Repeats {
 public:
  Repeats(const CalibratedScan& calibrated, const CheckInputs& inputs) : calibrated_(calibrated), inputs_(inputs) {}

  ScanCheck check() {
    compare_points();
    compare_visits();
    judge_groups(check_, groups_, check_.compared);
    if (check_.finding.empty() && check_.compared > 0) check_.finding = sentence();
    return std::move(check_);
  }

 private:
  void add(Group group, const std::vector<std::int32_t>& points) {
    if (group.size() < 2) return;
    for (std::size_t k = 1; k < group.size(); ++k) {
      ++check_.compared;
      const double z = z_between(group.front(), group[k]);
      if (std::abs(z) <= std::abs(check_.worst_z)) continue;
      check_.worst_z = z;
      check_.worst_points = {points.front()};
      if (points[k] != points.front()) check_.worst_points.push_back(points[k]);
    }
    groups_.push_back(std::move(group));
  }

  void compare_points() {
    std::map<std::int32_t, PlannedPlace> place_of;
    for (const PlannedPoint& point : inputs_.scan.points) {
      place_of[point.index] = planned_place(point, inputs_.scan.isotropic);
    }
    std::map<PlannedPlace, std::pair<Group, std::vector<std::int32_t>>> places;
    for (const CalibratedPoint& point : calibrated_.points) {
      const auto made = symmetry_point(point, calibrated_.components);
      if (!made) continue;
      auto& [group, points] = places[place_of[point.point_index]];
      group.push_back({made->value.si(), made->u_random.si(), reflectance::SharedEffects(made->shared)});
      points.push_back(point.point_index);
    }
    for (auto& [place, found] : places) add(std::move(found.first), found.second);
  }

  // q of the sample at one geometry, cleared of the drift that visits of the standard saw.
  void compare_visits() {
    const ScanHistories histories(inputs_.scan, inputs_.instrument, {});
    std::map<std::int32_t, Group> places;
    for (const RawReading& raw : inputs_.scan.readings) {
      if (raw.target != Target::Sample || raw.point_index || !raw.visited_point) continue;
      const auto level = level_of(raw, histories.context());
      if (!level) continue;
      Group& group = places[*raw.visited_point];
      group.push_back(member_of(*level, histories.drift_at(level->reading.at), *raw.visited_point));
    }
    for (auto& [point, group] : places) {
      const std::vector<std::int32_t> points(group.size(), point);
      add(std::move(group), points);
    }
  }

  [[nodiscard]] reflectance::GroupMember member_of(const LevelReading& level, const std::optional<DriftLevel>& drift,
                                                   std::int32_t point) const {
    const LampModel& lamp = inputs_.instrument.lamp;
    const double q = level.reading.q;
    double relative = widened(lamp.reproducibility_dof) * lamp.u_reproducibility * lamp.u_reproducibility +
                      0.5 * lamp.u_after_monitor * lamp.u_after_monitor + std::pow(angle_part(point), 2);
    double g = 1.0;
    if (drift) {
      g = drift->level;
      if (drift->before != nullptr) relative += std::pow((1.0 - drift->weight_after) * drift->before->u / g, 2);
      if (drift->after != nullptr) relative += std::pow(drift->weight_after * drift->after->u / g, 2);
      const double bridge = std::max(drift->change, drift->wander) / g;
      relative += bridge * bridge * (drift->is_between() ? drift->weight_after * (1.0 - drift->weight_after) : 1.0);
    }
    return {q / g, std::sqrt(level.u * level.u + q * q * relative) / g, {}};
  }

  // What placing the arms anew does to the sample's reading, relative, as the budget of that point has it.
  [[nodiscard]] double angle_part(std::int32_t index) const {
    for (const CalibratedPoint& point : calibrated_.points) {
      if (point.point_index != index || point.value.si() == 0.0) continue;
      for (const BudgetTerm& term : point.budget.random) {
        if (!calibrated_.components[term.component].name.starts_with("angle repeatability of the sample")) continue;
        return term.per_sd / point.value;
      }
    }
    return 0.0;
  }

  [[nodiscard]] std::string sentence() const {
    std::string text = fmt::format(
        "{} repeats of points and check visits: chi-square {:.1f} for {:.0f} degrees of freedom, "
        "worst {:+.1f} u",
        check_.compared, check_.chi_square, check_.degrees_of_freedom, check_.worst_z);
    if (!check_.worst_points.empty()) text += fmt::format(" at point {}", check_.worst_points.back());
    return check_.verdict == CheckVerdict::Failed ? text + ": the sample or the instrument changed meanwhile" : text;
  }

  const CalibratedScan& calibrated_;
  const CheckInputs& inputs_;
  ScanCheck check_{.kind = CheckKind::Repeats, .unit = "repeats"};
  std::vector<Group> groups_;
};

}  // namespace

ScanCheck check_repeats(const CalibratedScan& calibrated, const CheckInputs& inputs) {
  return Repeats(calibrated, inputs).check();
}

}  // namespace gonio::calibration
