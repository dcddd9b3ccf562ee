#include "calibration/point_equation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "calibration/absolute_factor.h"
#include "calibration/mounting_term.h"

namespace gonio::calibration {
namespace {

// A quarter of a degree about the geometry, within the table.
ShapeSteps steps_about(const ReferenceStandard& standard, const Geometry& at) {
  constexpr Angle kStep = degrees(0.25);
  return {{{at.theta_i - kStep, std::min(at.theta_i + kStep, standard.last_theta_i())},
           {at.theta_r - kStep, std::min(at.theta_r + kStep, standard.last_theta_r())},
           {at.phi_r - kStep, at.phi_r + kStep}}};
}

Error no_light(const PlannedPoint& point, std::int64_t reading, const NormalisedReading& q, bool is_power) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = fmt::format("calibrate point {}", point.index),
          .seen = fmt::format("reference reading {} of {:.4g} {} net", reading, q.mean_net_dn,
                              is_power ? "of its range" : "DN"),
          .limit = "more than 0"};
}

// The directions in the frame of the surface, and what its place does to the light: the source's distance squared.
double place_on(NormalisedReading& reading, const AngleModel& angles, const MountModel* mount, Length source_distance) {
  reading.geometry.theta_i += angles.zero[0];
  reading.geometry.theta_r += angles.zero[1];
  reading.geometry.phi_r += angles.zero[2];
  if (mount == nullptr) return 1.0;
  const SurfaceView view = view_on(*mount, source_distance, reading.geometry);
  reading.geometry = view.geometry;
  return view.irradiance;
}

double place_both(PairedPoint& pair, const InstrumentModel& instrument, bool is_mounting_known) {
  const MountingModel* mounting = is_mounting_known && instrument.mounting ? &*instrument.mounting : nullptr;
  const Length distance = mounting != nullptr ? mounting->source_distance : Length{};
  const double sample =
      place_on(pair.sample, instrument.angles, mounting != nullptr ? &mounting->sample : nullptr, distance);
  const double reference =
      place_on(pair.reference, instrument.angles, mounting != nullptr ? &mounting->reference : nullptr, distance);
  return reference / sample;
}

void evaluate(PairedPoint& pair, const EquationContext& context) {
  const double mu_s = std::cos(pair.sample.geometry.theta_i.si());
  const double f_ref = pair.standard.rho.value * pair.standard.shape / std::numbers::pi;
  pair.dvalue_dq = f_ref * pair.geometry_ratio * pair.drift_ratio / pair.reference.q;
  pair.stray = 1.0 / (std::numbers::pi * mu_s);
  double background = 0.0;
  const auto& stray = context.instrument->stray;
  if (stray && !context.histories->has_trap_visits() && !context.left_out.stray) {
    background = stray->source_share.value * pair.stray;
    pair.dvalue_dq += background * pair.drift_ratio / pair.reference.q;
  }
  pair.value = pair.dvalue_dq * pair.sample.q - background;
}

// The standard at the same geometry, or its visits at the anchor at the sample's moment.
Result<void> add_reference(PairedPoint& pair, const ReadingPair& readings, const EquationContext& context) {
  if (const auto& anchor = context.histories->anchor()) {
    auto found = anchor->at(pair.wavelength, pair.sample.at);
    if (!found) return failure(std::move(found).error());
    pair.reference = std::move(found->reading);
    pair.reference_id = found->reading_id;
    pair.terms = std::move(found->terms);
    pair.u_drift_rest = found->u_drift_rest;
    pair.drift_rest_dof = found->drift_rest_dof;
    pair.is_anchor_drifted = found->is_large;
    return {};
  }
  GONIO_TRY(normalise(*readings.reference, context.histories->context(), pair.reference));
  pair.reference_id = readings.reference->id;
  pair.reference_is_shared = readings.is_shared;
  return {};
}

void take_geometry(PairedPoint& pair, GeometryRatio ratio) {
  pair.geometry_ratio = ratio.factor;
  pair.sample_log_slope = ratio.sample_slope;
  pair.reference_log_slope = ratio.reference_slope;
  pair.is_mixed = ratio.is_mixed;
  pair.terms.insert(pair.terms.end(), std::make_move_iterator(ratio.terms.begin()),
                    std::make_move_iterator(ratio.terms.end()));
}

Result<void> by_direct_beam(PairedPoint& pair, const EquationContext& context) {
  const InstrumentModel& instrument = *context.instrument;
  const MountingModel* mounting = instrument.mounting && !context.left_out.mounting ? &*instrument.mounting : nullptr;
  const double nearness = place_on(pair.sample, instrument.angles, mounting != nullptr ? &mounting->sample : nullptr,
                                   mounting != nullptr ? mounting->source_distance : Length{});
  auto ratio = absolute_ratio(pair.sample.geometry, pair.wavelength, instrument, context.left_out);
  if (!ratio) return failure(std::move(ratio).error());
  pair.sample_log_slope = ratio->sample_slope;
  pair.is_mixed = ratio->is_mixed;
  pair.terms = std::move(ratio->terms);
  pair.reference.q = 1.0;
  pair.reference.mean_net_dn = ratio->beam_net_dn;
  pair.reference.dlnq_dt0 = ratio->beam_dlnq_dt0;
  pair.standard.rho.value = 1.0;
  pair.dvalue_dq = ratio->dvalue_dq / nearness;
  pair.value = pair.dvalue_dq * pair.sample.q;
  return {};
}

// As new, but for the memory of its lists. One by one, for a new one to be copied is a fifth of the whole equation; the
// readings are made anew by who normalises them.
void begin_anew(const PlannedPoint& point, ReferenceMode mode, PairedPoint& pair) {
  pair.mode = mode;
  if (mode == ReferenceMode::Absolute) pair.reference = {};
  pair.reference_id = 0;
  pair.reference_is_shared = false;
  pair.wavelength = point.wavelength;
  pair.polarisation = point.polarisation;
  pair.is_blocked = point.is_blocked;
  pair.is_beyond_standard = false;
  pair.standard = {};
  pair.geometry_ratio = 1.0;
  pair.sample_log_slope = {};
  pair.reference_log_slope = {};
  pair.value = pair.stray = pair.dvalue_dq = 0.0;
  pair.drift_ratio = 1.0;
  pair.sample_drift.reset();
  pair.reference_drift.reset();
  pair.terms.clear();
  pair.u_drift_rest = 0.0;
  pair.drift_rest_dof = std::numeric_limits<double>::infinity();
  pair.is_mixed = false;
  pair.is_anchor_drifted = false;
}

}  // namespace

Result<void> equate(const PlannedPoint& point, const ReadingPair& readings, const EquationContext& context,
                    PairedPoint& pair) {
  begin_anew(point, context.histories->mode(), pair);
  GONIO_TRY(normalise(*readings.sample, context.histories->context(), pair.sample));
  if (pair.mode == ReferenceMode::Absolute) return by_direct_beam(pair, context);
  GONIO_TRY(add_reference(pair, readings, context));
  const double nearness = place_both(pair, *context.instrument, !context.left_out.mounting);
  const ReferenceStandard& standard = *context.standard;
  GONIO_TRY(standard.check_reach(point.wavelength, pair.reference.geometry));
  if (!(pair.reference.q > 0.0)) {
    return failure(no_light(point, pair.reference_id, pair.reference, context.instrument->detector.power.has_value()));
  }
  pair.is_beyond_standard = standard.is_extrapolated(pair.reference.geometry);
  pair.standard.rho = standard.reflectance(point.wavelength).value();
  if (!context.left_out.shape) pair.standard.shape = standard.shape(pair.reference.geometry, point.wavelength);
  take_geometry(pair,
                geometry_ratio(pair.sample.geometry, pair.reference.geometry, *context.instrument, context.left_out));
  pair.geometry_ratio *= nearness;
  context.histories->find_drift(pair.sample.at, pair.sample_drift);
  if (pair.sample_drift) {
    context.histories->find_drift(pair.reference.at, pair.reference_drift);
    pair.drift_ratio = pair.reference_drift->level / pair.sample_drift->level;
  }
  evaluate(pair, context);
  return {};
}

void add_standard_slopes(const EquationContext& context, PairedPoint& pair) {
  if (pair.mode == ReferenceMode::Absolute || context.left_out.shape) return;
  const ShapeSteps steps = steps_about(*context.standard, pair.reference.geometry);
  const ShapeRises rises = context.standard->shape_rises(pair.reference.geometry, pair.wavelength, steps);
  for (std::size_t a = 0; a < kDirectionAxes; ++a) {
    pair.standard.slope[a] = rises[a] / ((steps[a][1] - steps[a][0]).si() * pair.standard.shape);
  }
}

}  // namespace gonio::calibration
