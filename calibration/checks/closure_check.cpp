// The standard, read again.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "calibration/checks/check_parts.h"

namespace gonio::calibration {
namespace {

using Group = std::vector<reflectance::GroupMember>;

struct VisitLevel {
  double at_s = 0.0;
  double level = 0.0;
  double u = 0.0;
};

/// What a visit of the standard is beside the line between its neighbours.
class VisitClosure {
 public:
  explicit VisitClosure(const CheckInputs& inputs) : inputs_(inputs) {
    const ScanHistories histories(inputs.scan, inputs.instrument, {});
    for (const RawReading& raw : inputs.scan.readings) {
      if (raw.target != Target::Reference || raw.point_index || !raw.visited_point) continue;
      const auto level = level_of(raw, histories.context());
      if (level) places_[{*raw.visited_point, raw.wavelength}].push_back(of(*level));
    }
  }

  void compare(ScanCheck& check) const {
    for (const auto& [place, visits] : places_) {
      for (std::size_t k = 1; k + 1 < visits.size(); ++k) {
        if (visits[k + 1].at_s <= visits[k - 1].at_s) continue;
        ++check.compared;
        const double z = z_of(visits[k - 1], visits[k], visits[k + 1]);
        if (std::abs(z) <= std::abs(check.worst_z)) continue;
        check.worst_z = z;
        check.worst_points = {place.first};
      }
    }
  }

 private:
  [[nodiscard]] VisitLevel of(const LevelReading& level) const {
    const LampModel& lamp = inputs_.instrument.lamp;
    const double tilt = std::tan(level.reading.geometry.theta_i.si()) * inputs_.instrument.angles.u_repeat.si();
    const double relative2 =
        widened(lamp.reproducibility_dof) * lamp.u_reproducibility * lamp.u_reproducibility + tilt * tilt;
    const double q = level.reading.q;
    return {in_seconds(level.reading.at.time_since_epoch()), q, std::sqrt(level.u * level.u + q * q * relative2)};
  }

  // The lamp's wander after the monitor is a stationary process of variance u^2 / 2 and Gaussian correlation. A change
  // over the whole interval may have come as one step anywhere in it, which is what the budget allows for.
  [[nodiscard]] double z_of(const VisitLevel& a, const VisitLevel& b, const VisitLevel& c) const {
    const double p = (b.at_s - a.at_s) / (c.at_s - a.at_s);
    const double expected = a.level + p * (c.level - a.level);
    const LampModel& lamp = inputs_.instrument.lamp;
    const auto correlation = [&](double apart_s) { return std::exp(-0.5 * std::pow(apart_s / lamp.correlation_s, 2)); };
    const double wander = 0.5 * lamp.u_after_monitor * lamp.u_after_monitor *
                          (1.0 + (1.0 - p) * (1.0 - p) + p * p - 2.0 * (1.0 - p) * correlation(b.at_s - a.at_s) -
                           2.0 * p * correlation(c.at_s - b.at_s) + 2.0 * p * (1.0 - p) * correlation(c.at_s - a.at_s));
    const double step = (c.level - a.level) * (c.level - a.level) * p * (1.0 - p);
    const double variance = b.u * b.u + std::pow((1.0 - p) * a.u, 2) + std::pow(p * c.u, 2) +
                            std::max(0.0, wander) * b.level * b.level + step;
    return variance > 0.0 ? (b.level - expected) / std::sqrt(variance) : 0.0;
  }

  const CheckInputs& inputs_;
  std::map<std::pair<std::int32_t, Wavelength>, std::vector<VisitLevel>> places_;
};

/// f_s of the standard as sample, less its own f_ref at the same directions: what the certificate says of both cancels.
class SampleClosure {
 public:
  SampleClosure(const CalibratedScan& calibrated, const CheckInputs& inputs)
      : calibrated_(calibrated), inputs_(inputs) {
    for (std::uint32_t c = 0; c < calibrated.components.size(); ++c) by_name_[calibrated.components[c].name] = c;
  }

  std::vector<Group> compare(ScanCheck& check) const {
    std::vector<Group> groups;
    for (const CalibratedPoint& point : calibrated_.points) {
      const auto made = symmetry_point(point, calibrated_.components);
      if (!made || !inputs_.standard.check_reach(point.wavelength, point.geometry)) continue;
      const double f_ref = inputs_.standard.reflectance(point.wavelength)->value *
                           inputs_.standard.shape(point.geometry, point.wavelength) / std::numbers::pi;
      reflectance::SharedEffects shared(made->shared);
      shared.add(of_the_standard(point, f_ref), -1.0);
      shared.drop_up_to(1e-12 * f_ref);
      const double u = made->u_random.si();
      const double difference = point.value.si() - f_ref;
      ++check.compared;
      const double z = difference / std::hypot(u, size_of(shared));
      if (std::abs(z) > std::abs(check.worst_z)) {
        check.worst_z = z;
        check.worst_points = {point.point_index};
      }
      // Beside a value known to be 0, so that the group's mean is fixed.
      groups.push_back({{difference, u, std::move(shared)}, {0.0, 1e-3 * u, {}}});
    }
    return groups;
  }

 private:
  // What the standard's own components do to f_ref here.
  [[nodiscard]] reflectance::SharedEffects of_the_standard(const CalibratedPoint& point, double f_ref) const {
    const ReferenceStandard& standard = inputs_.standard;
    std::vector<reflectance::SharedEffect> effects;
    const auto add = [&](const std::string& name, double relative) {
      const auto found = by_name_.find(name);
      if (found != by_name_.end()) effects.push_back({found->second, per_steradian(f_ref * relative)});
    };
    const auto errors = standard.certificate_errors(point.wavelength);
    for (const CertificateError& error : *errors) {
      add(certificate_error_name(standard.certificate(), error), error.u);
    }
    for (std::size_t k = 0; k < standard.modes().size(); ++k) {
      const ShapeMode& mode = standard.modes()[k];
      add("shape mode " + mode.name, standard.mode(k, point.geometry, point.wavelength) * mode.u);
    }
    add("shape integral", standard.u_integral());
    return reflectance::SharedEffects(effects);
  }

  const CalibratedScan& calibrated_;
  const CheckInputs& inputs_;
  std::map<std::string, std::uint32_t> by_name_;
};

}  // namespace

ScanCheck check_closure(const CalibratedScan& calibrated, const CheckInputs& inputs) {
  ScanCheck check{.kind = CheckKind::Closure, .unit = "readings of the standard to compare"};
  std::vector<Group> groups;
  if (inputs.sample_is_the_standard) groups = SampleClosure(calibrated, inputs).compare(check);
  VisitClosure(inputs).compare(check);
  if (groups.empty())
    judge_by_worst(check, check.compared);
  else
    judge_groups(check, groups, check.compared);
  if (!check.finding.empty() || check.compared == 0) return check;
  check.finding =
      fmt::format("{} {}: worst {:+.1f} u{}{}", check.compared, check.unit, check.worst_z,
                  check.worst_points.empty() ? "" : fmt::format(" at point {}", check.worst_points[0]),
                  check.verdict == CheckVerdict::Failed
                      ? ": the standard is not what its file says, or the instrument drifts more than is stated"
                      : "");
  return check;
}

}  // namespace gonio::calibration
