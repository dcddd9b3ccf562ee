#include "calibration/cone_correction.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace gonio::calibration {
namespace {

constexpr double kConePole = 0.02;  // sin(theta): there a direction's own azimuth is no line

/// Delta f - 2 tan(theta) f_theta of one direction.
struct ConeOperator {
  double value = 0.0;
  double unresolved = 0.0;
  double noise = 0.0;
};

double hypot_of(double a, double b) {
  return std::sqrt(a * a + b * b);
}

ConeOperator operator_of(const DirectionSlopes& s, std::size_t axis, Angle theta) {
  constexpr std::size_t kPhi = 2;
  const double sine = std::abs(std::sin(theta.si()));
  const double cosine = std::cos(theta.si());
  if (sine < kConePole) {
    return {.value = 2.0 * s.curvature[axis],
            .unresolved = hypot_of(2.0 * s.unresolved_curvature[axis], s.curvature[axis]),
            .noise = 2.0 * s.curvature_noise[axis]};
  }
  if (!s.has_bend_along_phi) {  // Delta f = f_thetatheta + f_tt, t across theta: about as large as along
    const double slope = -2.0 * sine / cosine;
    return {.value = s.curvature[axis] + slope * s.slope[axis],
            .unresolved = hypot_of(hypot_of(s.unresolved_curvature[axis], slope * s.unresolved[axis]),
                                   hypot_of(s.curvature[axis], s.unresolved_curvature[axis])),
            .noise = s.curvature_noise[axis]};
  }
  const double along = cosine / sine - 2.0 * sine / cosine;
  const double across = 1.0 / (sine * sine);
  return {.value = s.curvature[axis] + along * s.slope[axis] + across * s.curvature[kPhi],
          .unresolved = hypot_of(hypot_of(s.unresolved_curvature[axis], along * s.unresolved[axis]),
                                 across * s.unresolved_curvature[kPhi]),
          .noise = hypot_of(s.curvature_noise[axis], across * s.curvature_noise[kPhi])};
}

double kappa(Angle half) {
  return 0.25 * (1.0 - std::cos(half.si()));
}
double kappa_u(const Measured<Angle>& half) {
  return 0.25 * std::sin(half.value.si()) * half.u.si();
}

/// The spacing of a table's nodes about an angle: what a straight line between two of them bends over.
Angle spacing(const std::vector<Angle>& nodes, Angle at) {
  const auto above = std::ranges::upper_bound(nodes, at);
  if (above == nodes.begin()) return nodes[1] - nodes[0];
  if (above == nodes.end()) return nodes.back() - nodes[nodes.size() - 2];
  return *above - *(above - 1);
}

// Slopes and second derivatives of ln-free s(G) by central differences over the table's own spacing, kept within it.
DirectionSlopes bends_of(const ReferenceStandard& standard, const Geometry& g, Wavelength wavelength) {
  DirectionSlopes s;
  s.has_bend_along_phi = true;
  const double middle = standard.shape(g, wavelength);
  const auto fill = [&](std::size_t axis, Angle step, Angle last) {
    const auto angle = [axis](Geometry& at) -> Angle& {
      return axis == 0 ? at.theta_i : axis == 1 ? at.theta_r : at.phi_r;
    };
    Geometry low = g;
    Geometry high = g;
    const Angle room = axis == 2 ? step : std::max(last - angle(high), radians(1e-4));
    const Angle reach = std::min(step, room);
    angle(low) -= reach;
    angle(high) += reach;
    const double h = reach.si();
    const double rise = standard.shape(high, wavelength) - middle;
    const double fall = middle - standard.shape(low, wavelength);
    s.slope[axis] = (rise + fall) / (2.0 * h);
    s.curvature[axis] = reach < step ? 0.0 : (rise - fall) / (h * h);  // at the edge no bend is seen
  };
  const ShapeTable& table = standard.shapes().front().table;
  fill(0, spacing(table.theta_i(), g.theta_i), standard.last_theta_i());
  fill(1, spacing(table.theta_r(), g.theta_r), standard.last_theta_r());
  const Angle dphi = wrapped(g.phi_r - g.phi_i);
  fill(2, spacing(table.phi(), dphi < Angle{} ? -dphi : dphi), Angle{});
  return s;
}

}  // namespace

ConeCorrection cone_correction(const PairedPoint& point, const DirectionSlopes& slopes,
                               const InstrumentModel& instrument, const ReferenceStandard& standard) {
  ConeCorrection c;
  if (!instrument.cones) return c;
  const ConeModel& cones = *instrument.cones;
  const double source = kappa(cones.source_half.value);
  const double detector = kappa(cones.detector_half.value);
  const ConeOperator i = operator_of(slopes, 0, point.sample.geometry.theta_i);
  const ConeOperator r = operator_of(slopes, 1, point.sample.geometry.theta_r);
  const DirectionSlopes bends = bends_of(standard, point.reference.geometry, point.wavelength);
  const bool has_standard = point.mode != ReferenceMode::Absolute;
  const double per_shape = has_standard ? point.value / point.standard.shape : 0.0;
  const double i_ref = per_shape * operator_of(bends, 0, point.reference.geometry.theta_i).value;
  const double r_ref = per_shape * operator_of(bends, 1, point.reference.geometry.theta_r).value;
  c.sample_bias = source * i.value + detector * r.value;
  c.bias = c.sample_bias - source * i_ref - detector * r_ref;
  const double unresolved = hypot_of(source * i.unresolved, detector * r.unresolved);
  const double size = std::max(std::abs(point.value), 1e-300);
  const double next_order = std::min(c.sample_bias * c.sample_bias / size, std::abs(c.sample_bias));
  c.u_unresolved = hypot_of(unresolved, next_order);
  c.u_noise = hypot_of(source * i.noise, detector * r.noise);
  c.per_source_u = -kappa_u(cones.source_half) * (i.value - i_ref);
  c.per_detector_u = -kappa_u(cones.detector_half) * (r.value - r_ref);
  constexpr double kLimited = 0.1;
  c.is_limited = std::abs(c.sample_bias) + unresolved > kLimited * size && size > 3.0 * c.u_noise;
  return c;
}

void add_cone_terms(const ConeCorrection& c, const InstrumentModel& instrument, TermList& terms) {
  if (!instrument.cones) return;
  const ConeModel& cones = *instrument.cones;
  const std::string owner = instrument.version.empty() ? "" : "instrument " + instrument.version;
  terms.shared({ComponentSource::ConeSize, 0}, in_degrees(cones.source_half.u), "deg", c.per_source_u,
               [] { return "half angle of the source's cone"; }, {.owner = owner});
  terms.shared({ComponentSource::ConeSize, 1}, in_degrees(cones.detector_half.u), "deg", c.per_detector_u,
               [] { return "half angle of the detector's cone"; }, {.owner = owner});
  terms.shared({ComponentSource::ConeCurvature}, 1.0, "of what the points do not resolve", c.u_unresolved,
               [] { return "cones through unresolved curvature"; }, {.is_pattern_known = false});
  if (c.u_noise > 0.0) {
    terms.random(ComponentSource::ConeNoise, "noise of the cones' correction", 0.0, "sr^-1", c.u_noise);
  }
}

}  // namespace gonio::calibration
