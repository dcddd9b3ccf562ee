#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "daemon/planner/estimate.h"
#include "daemon/planner/planner.h"
#include "drivers/keep_out/path_conflict.h"
#include "drivers/kinematics/kinematics.h"

namespace gonio::daemon {

namespace {

using stage::Axis;

// Encoders and lists carry rounding: a value so little beyond a limit stands on it.
constexpr double kLimitSlack = 1e-9;

bool is_within(const drivers::AxisConfig& axis, double position) {
  return position >= axis.low - kLimitSlack && position <= axis.high + kLimitSlack;
}

Error beyond_limit(Axis axis, const drivers::AxisConfig& config, double position) {
  const auto unit = stage::axis_unit(axis);
  return Error{.code = ErrorCode::OutOfLimits,
               .device = "stage",
               .tried = fmt::format("move {} to {:.3f} {}", stage::axis_name(axis), position, unit),
               .seen = fmt::format("target {:.3f} {}", position, unit),
               .limit = fmt::format("{:.3f} to {:.3f} {}", config.low, config.high, unit)};
}

Result<double> within_limits(const Instrument& instrument, Axis axis, double position) {
  const auto& config = instrument.stage.axis(axis);
  if (!is_within(config, position)) return failure(beyond_limit(axis, config, position));
  return std::clamp(position, config.low, config.high);
}

Result<double> filter_slot(const Instrument& instrument, Wavelength wavelength, bool is_attenuated) {
  const Filter* filter =
      is_attenuated ? attenuated_filter_for(instrument, wavelength) : filter_for(instrument, wavelength);
  if (filter != nullptr) return static_cast<double>(filter->slot);
  std::string known;
  for (const Filter& one : instrument.filters) {
    if (one.attenuation.has_value() != is_attenuated) continue;
    known += fmt::format("{}{:g}", known.empty() ? "" : ", ", in_nanometres(one.centroid));
  }
  return failure(
      Error{.code = ErrorCode::InvalidInput,
            .device = "stage",
            .tried = is_attenuated ? "find the attenuator of a wavelength, to look into the source"
                                   : "find the filter of a wavelength",
            .seen = fmt::format("{:g} nm", in_nanometres(wavelength)),
            .limit = fmt::format("filters{} with centroids at {} nm", is_attenuated ? " with an attenuation" : "",
                                 known.empty() ? "no" : known)});
}

const drivers::MotionTarget& clear_way(const std::vector<drivers::MotionTarget>& ways, const Instrument& instrument,
                                       const stage::PerAxis<double>& standing) {
  if (!instrument.stage.keep_out) return ways.front();
  const auto clear =
      std::ranges::find_if(ways, [&](const auto& way) { return step_time(instrument, standing, way).has_value(); });
  return clear == ways.end() ? ways.front() : *clear;
}

}  // namespace

bool is_in_shadow(const Geometry& g, const Shadow& shadow) {
  const double reach = (shadow.detector_head_radius + shadow.source_head_radius).si() /
                       std::min(shadow.detector_arm, shadow.source_arm).si();
  return phase_angle(g).si() < std::asin(std::min(1.0, reach));
}

bool is_blocked(const Geometry& g, const Instrument& instrument) {
  if (is_in_shadow(g, instrument.shadow)) return true;
  const auto& keep_out = instrument.stage.keep_out;
  return keep_out && phase_angle(g) < keep_out->least_separation() + drivers::kPathResolution;
}

bool is_below_surface(const Geometry& g) {
  constexpr Angle kHorizon = degrees(90.0);
  return g.theta_i >= kHorizon || g.theta_r >= kHorizon;
}

Length carriage_place(const Instrument& instrument, calibration::Target target, const Geometry& g) {
  const CarriagePositions& carriage = instrument.carriage;
  if (is_below_surface(g)) return carriage.open.value_or(carriage.sample);
  return target == calibration::Target::Sample ? carriage.sample : carriage.reference;
}

stage::PerAxis<double> home_position(const Instrument& instrument) {
  stage::PerAxis<double> home{};
  for (const Axis axis : stage::kAllAxes) {
    const auto& config = instrument.stage.axis(axis);
    home[stage::index_of(axis)] = std::clamp(0.0, config.low, config.high);
  }
  return home;
}

Result<drivers::MotionTarget> axis_targets(const Geometry& g, Wavelength wavelength, const Instrument& instrument,
                                           const stage::PerAxis<double>& standing) {
  const auto ways = drivers::solutions(g, instrument.stage, standing);
  if (!ways) return failure(ways.error());
  const auto slot = filter_slot(instrument, wavelength, is_below_surface(g));
  if (!slot) return failure(slot.error());
  drivers::MotionTarget target = clear_way(*ways, instrument, standing);
  target[stage::index_of(Axis::FilterWheel)] = *slot;
  return target;
}

Result<void> check_move(const drivers::MotionTarget& target, const stage::PerAxis<double>& standing,
                        const Instrument& instrument) {
  stage::PerAxis<double> there = standing;
  for (const Axis axis : stage::kAllAxes) {
    const auto& asked = target[stage::index_of(axis)];
    if (!asked) continue;
    if (!std::isfinite(*asked)) {
      return failure(Error{.code = ErrorCode::InvalidInput,
                           .device = "stage",
                           .tried = fmt::format("move {}", stage::axis_name(axis)),
                           .seen = "a target that is not a number",
                           .limit = "a finite number"});
    }
    const auto allowed = within_limits(instrument, axis, *asked);
    if (!allowed) return failure(allowed.error());
    there[stage::index_of(axis)] = *allowed;
  }
  const bool arms_move = target[0] || target[1] || target[2] || target[3];
  const Geometry g = drivers::directions(instrument.stage.kinematics, there);
  if (!arms_move) return {};
  if (!is_in_shadow(g, instrument.shadow)) {
    const auto way = step_time(instrument, standing, target);
    return way ? Result<void>() : failure(way.error());
  }
  const double xi_deg = in_degrees(phase_angle(g));
  return failure(Error{.code = ErrorCode::Blocked,
                       .device = "stage",
                       .tried = fmt::format("move to theta_i {:.3f} deg, theta_r {:.3f} deg, phi_r {:.3f} deg",
                                            in_degrees(g.theta_i), in_degrees(g.theta_r), in_degrees(g.phi_r)),
                       .seen = fmt::format("phase angle {:.3f} deg, in the shadow of the detector's head", xi_deg),
                       .limit = "outside of the keep-out about retro-reflection"});
}

}  // namespace gonio::daemon
