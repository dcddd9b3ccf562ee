#include "calibration/absolute_factor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace gonio::calibration {
namespace {

double squared_ratio(double x) {
  return x * x;
}

Error incomplete(Wavelength wavelength, std::string seen, std::string limit) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = fmt::format("calibrate by the direct beam at {:g} nm", in_nanometres(wavelength)),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

const DirectBeam* beam_at(const AbsoluteModel& absolute, Wavelength wavelength) {
  constexpr Wavelength kSame = nanometres(0.05);
  const auto found = std::find_if(absolute.beams.begin(), absolute.beams.end(), [&](const DirectBeam& beam) {
    return beam.wavelength - wavelength < kSame && wavelength - beam.wavelength < kSame;
  });
  return found == absolute.beams.end() ? nullptr : &*found;
}

}  // namespace

Measured<SolidAngle> detector_solid_angle(const AbsoluteModel& absolute, Length spot_radius, const Geometry& g) {
  const double a = absolute.aperture_radius.value / absolute.aperture_distance.value;
  const double spot = spot_radius / absolute.aperture_distance.value;
  const double stretch = 1.0 / std::cos(g.theta_i.si());
  const double dphi = (g.phi_r - g.phi_i).si();
  const double p2 = 0.25 * spot * spot * (stretch * stretch + 1.0);
  const double x2 = 0.25 * squared_ratio(spot * std::sin(g.theta_r.si())) *
                    (squared_ratio(stretch * std::cos(dphi)) + squared_ratio(std::sin(dphi)));
  const double sr = std::numbers::pi * a * a * (1.0 - 2.0 * (0.5 * a * a + p2 - 4.0 * x2));
  const double u = 2.0 * std::hypot(absolute.aperture_radius.u / absolute.aperture_radius.value,
                                    absolute.aperture_distance.u / absolute.aperture_distance.value);
  return {steradians(sr), steradians(sr * u)};
}

Result<AbsoluteRatio> absolute_ratio(const Geometry& sample, Wavelength wavelength, const InstrumentModel& instrument,
                                     const LeftOut& left_out) {
  constexpr Angle kHorizon = degrees(90.0);
  if (sample.theta_i >= kHorizon || sample.theta_r >= kHorizon) {
    return failure(incomplete(wavelength, "a direction below the surface, where the detector looks into the source",
                              "both above it"));
  }
  if (!instrument.absolute || !instrument.overlap) {
    return failure(incomplete(wavelength, instrument.absolute ? "no spot and field of view" : "no direct beam",
                              "a direct beam, a stop, and the radii of spot and field of view"));
  }
  const AbsoluteModel& absolute = *instrument.absolute;
  const DirectBeam* beam = beam_at(absolute, wavelength);
  if (beam == nullptr) return failure(incomplete(wavelength, "no direct beam at this wavelength", "one"));
  if (!(beam->q.value > 0.0)) {
    return failure(incomplete(wavelength, fmt::format("a direct beam of {:g}", beam->q.value), "more than 0"));
  }
  const Length spot = instrument.overlap->spot_radius.value;
  const double omega = detector_solid_angle(absolute, spot, sample).value.si();
  const double whole = beam->q.value / beam->attenuation.value;
  AbsoluteRatio ratio{.beam_net_dn = beam->mean_net_dn, .beam_dlnq_dt0 = beam->dlnq_dt0};
  const GeometryTerms geometry = absolute_geometry(sample, instrument);
  const double mu_r = std::cos(sample.theta_r.si());
  ratio.dvalue_dq = (left_out.overlap ? 1.0 / mu_r : geometry.factor) / (whole * omega);
  ratio.sample_slope = geometry.slope;
  ratio.is_mixed = geometry.is_mixed;
  ratio.terms = geometry.terms;
  const auto add = [&](std::int64_t number, std::string name, double u, double per_sd, double dof) {
    if (u == 0.0) return;
    ratio.terms.push_back(
        {.key = {ComponentSource::DirectBeam, number, number <= 2 ? std::llround(in_nanometres(wavelength) * 1e3) : 0},
         .name = std::move(name),
         .u = u,
         .unit = "1",
         .owner = owner_of(instrument),
         .per_sd = per_sd,
         .degrees_of_freedom = dof});
  };
  constexpr double kKnown = std::numeric_limits<double>::infinity();
  const double u_beam = beam->q.u / beam->q.value;
  const double u_attenuation = beam->attenuation.u / beam->attenuation.value;
  const double u_radius = absolute.aperture_radius.u / absolute.aperture_radius.value;
  const double u_distance = absolute.aperture_distance.u / absolute.aperture_distance.value;
  add(1, fmt::format("direct beam at {:g} nm", in_nanometres(wavelength)), u_beam, -u_beam, beam->degrees_of_freedom);
  add(2, fmt::format("attenuator of the direct beam at {:g} nm", in_nanometres(wavelength)), u_attenuation,
      u_attenuation, kKnown);
  add(3, "radius of the detector's stop", u_radius, -2.0 * u_radius, kKnown);
  add(4, "distance of the detector's stop", u_distance, 2.0 * u_distance, kKnown);
  return ratio;
}

}  // namespace gonio::calibration
