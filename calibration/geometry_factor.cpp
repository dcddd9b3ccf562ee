#include "calibration/geometry_factor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "calibration/offset_overlap.h"
#include "calibration/overlap.h"
#include "calibration/profile_overlap.h"

namespace gonio::calibration {
namespace {

using Slopes = std::array<double, 3>;

Slopes of_radiance(const Geometry& g) {
  return {-std::tan(g.theta_i.si()), 0.0, 0.0};
}

Slopes of_intensity(const Geometry& g) {
  return {0.0, -std::tan(g.theta_r.si()), 0.0};
}

double relative_u(const Measured<Length>& length) {
  return length.u / length.value;
}

// Beyond it neither limit is in doubt, whatever the radii really are.
double margin_of(const OverlapModel& model) {
  constexpr double kLeast = 0.02;
  constexpr double kSurely = 3.0;
  return std::max(kLeast, kSurely * std::hypot(relative_u(model.spot_radius), relative_u(model.field_radius)));
}

/// One target's side of the ratio.
class Side {
 public:
  Side(const Geometry& g, const OverlapModel& model, const std::optional<Length>& target)
      : g_(g),
        model_(model),
        target_(target),
        discs_{
            .spot_radius = model.spot_radius.value, .field_radius = model.field_radius.value, .target_radius = target},
        mode_(beam_mode(discs_, g, margin_of(model))) {}

  [[nodiscard]] BeamMode mode() const { return mode_; }
  [[nodiscard]] bool has_profile() const { return !model_.spot_profile.empty() || !model_.field_profile.empty(); }

  [[nodiscard]] double log_h() const { return log_h(g_); }

  [[nodiscard]] Slopes slopes() const {
    if (!has_profile() && mode_ == BeamMode::Radiance) return of_radiance(g_);
    if (!has_profile() && mode_ == BeamMode::Intensity) return of_intensity(g_);
    const Angle step = radians(has_profile() ? 1e-3 : 1e-5);
    Slopes slopes{};
    for (std::size_t axis = 0; axis < slopes.size(); ++axis) {
      Geometry low = g_;
      Geometry high = g_;
      Angle Geometry::*const angle = axis == 0 ? &Geometry::theta_i : axis == 1 ? &Geometry::theta_r : &Geometry::phi_r;
      low.*angle -= step;
      high.*angle += step;
      slopes[axis] = (log_h(high) - log_h(low)) / (2.0 * step.si());
    }
    return slopes;
  }

  [[nodiscard]] Overlap even() const { return overlap_of(discs_, g_); }

  /// d ln O of one standard deviation of a radius. Over plus and minus one of them where the edges may cross: O has
  /// kinks where one ellipse comes out of another.
  [[nodiscard]] double per_sd(Length BeamDiscs::*radius, double u_relative, double by_radius) const {
    if (mode_ != BeamMode::Mixed || u_relative == 0.0) return by_radius * u_relative;
    BeamDiscs low = discs_;
    BeamDiscs high = discs_;
    low.*radius = (1.0 - u_relative) * low.*radius;
    high.*radius = (1.0 + u_relative) * high.*radius;
    return 0.5 * std::log(overlap_of(high, g_).area_mm2 / overlap_of(low, g_).area_mm2);
  }

  // What ln O loses when the spot is off by this much across its beam: in the plane of incidence, and across it.
  [[nodiscard]] std::array<double, 2> losses(Length offset) const {
    const double centred = std::log(overlap_of(discs_, g_).area_mm2);
    const double c = std::cos(g_.phi_i.si());
    const double s = std::sin(g_.phi_i.si());
    const Length along = offset / std::cos(g_.theta_i.si());
    const auto loss = [&](const SpotPlace& place) {
      return std::log(offset_overlap(discs_, g_, place).area_mm2) - centred;  // O is even in the offset
    };
    if (mode_ != BeamMode::Mixed && !has_profile()) return {};
    return {loss({.x = c * along, .y = s * along}), loss({.x = -s * offset, .y = c * offset})};
  }

 private:
  [[nodiscard]] double log_h(const Geometry& g) const {
    const double field_mm = in_millimetres(model_.field_radius.value);
    const double area_mm2 = has_profile() ? profile_overlap_mm2(model_, target_, g) : overlap_of(discs_, g).area_mm2;
    const double mu_i = std::cos(g.theta_i.si());
    const double mu_r = std::cos(g.theta_r.si());
    return std::log(mu_i * mu_r * area_mm2 / (std::numbers::pi * field_mm * field_mm));
  }

  const Geometry& g_;
  const OverlapModel& model_;
  const std::optional<Length>& target_;
  BeamDiscs discs_;
  BeamMode mode_;
};

/// Adds to the terms of a point, each under a number of its own.
class BeamTerms {
 public:
  BeamTerms(std::vector<RelativeTerm>& terms, const std::string& owner) : terms_(terms), owner_(owner) {}
  void add(std::int64_t number, std::string_view name, double u, std::string_view unit, double per_sd) {
    put(number, name, u, unit, owner_, per_sd);
  }
  /// Not the instrument's: of what lies on the stage.
  void add_own(std::int64_t number, std::string_view name, double u, double per_sd) {
    put(number, name, u, "1", {}, per_sd);
  }

 private:
  void put(std::int64_t number, std::string_view name, double u, std::string_view unit, const std::string& owner,
           double per_sd) {
    if (u == 0.0 || per_sd == 0.0) return;
    terms_.push_back({.key = {ComponentSource::Geometry, number},
                      .name = std::string(name),
                      .u = u,
                      .unit = std::string(unit),
                      .owner = owner,
                      .per_sd = per_sd});
  }
  std::vector<RelativeTerm>& terms_;
  const std::string& owner_;
};

/// d ln O of one standard deviation of each thing that O rests on, at one side.
struct Sensitivities {
  double spot = 0.0;
  double field = 0.0;
  double target = 0.0;
  double spot_falloff = 0.0;
  double field_falloff = 0.0;
  std::array<double, 2> offset{};
};

Sensitivities sensitivities(const Side& side, const OverlapModel& model, const std::optional<Length>& target) {
  const Overlap even = side.even();
  Sensitivities s{.spot = side.per_sd(&BeamDiscs::spot_radius, relative_u(model.spot_radius), even.by_spot),
                  .field = side.per_sd(&BeamDiscs::field_radius, relative_u(model.field_radius), even.by_field),
                  .target = target ? even.by_target * (model.u_target_radius / *target) : 0.0,
                  .spot_falloff = (1.0 - 2.0 * even.spot_mean_square) * model.u_spot_falloff,
                  .field_falloff = (1.0 - 2.0 * even.field_mean_square) * model.u_field_falloff};
  if (model.u_offset > Length{}) {
    s.offset = side.losses(model.u_offset);
    for (double& loss : s.offset) loss *= std::numbers::sqrt3;
  }
  return s;
}

// ln f_s goes as minus ln O of the sample and plus that of the reference, where there is one.
void add_beam_terms(BeamTerms terms, const OverlapModel& model, const Sensitivities& s, const Sensitivities& r,
                    double spot_area) {
  const auto u_of = [](const Length& u, const std::optional<Length>& of) { return of ? u / *of : 0.0; };
  terms.add(1, "radius of the lit spot", relative_u(model.spot_radius), "1", spot_area + r.spot - s.spot);
  terms.add(2, "radius of the field of view", relative_u(model.field_radius), "1", r.field - s.field);
  terms.add_own(3, "radius of the sample", u_of(model.u_target_radius, model.sample_radius), -s.target);
  terms.add_own(4, "radius of the reference", u_of(model.u_target_radius, model.reference_radius), r.target);
  terms.add(5, "unevenness of the lit spot", model.u_spot_falloff, "1", r.spot_falloff - s.spot_falloff);
  terms.add(6, "unevenness of the field of view", model.u_field_falloff, "1", r.field_falloff - s.field_falloff);
  const double u_mm = in_millimetres(model.u_offset);
  terms.add(7, "spot off the field, in the plane of incidence", u_mm, "mm", r.offset[0] - s.offset[0]);
  terms.add(8, "spot off the field, across the plane of incidence", u_mm, "mm", r.offset[1] - s.offset[1]);
}

// Read at the same place, on targets of the same size: what the terms leave is far below the angles' own.
bool cancels(const Geometry& a, const Geometry& b, const OverlapModel& model) {
  constexpr Angle kSame = degrees(0.05);
  const bool is_same_size = model.sample_radius == model.reference_radius && model.u_target_radius == Length{};
  return is_same_size && same_geometry(a, b, false, kSame);
}

}  // namespace

GeometryRatio geometry_ratio(const Geometry& sample, const Geometry& reference, const InstrumentModel& instrument,
                             const LeftOut& left_out) {
  GeometryRatio ratio{.factor = std::cos(reference.theta_i.si()) / std::cos(sample.theta_i.si()),
                      .sample_slope = of_radiance(sample),
                      .reference_slope = of_radiance(reference)};
  if (!instrument.overlap) return ratio;
  const OverlapModel& model = *instrument.overlap;
  const Side of_sample(sample, model, model.sample_radius);
  const Side of_reference(reference, model, model.reference_radius);
  if (!left_out.overlap) ratio.factor = std::exp(of_reference.log_h() - of_sample.log_h());
  ratio.is_mixed = of_sample.mode() == BeamMode::Mixed || of_reference.mode() == BeamMode::Mixed;
  ratio.sample_slope = of_sample.slopes();
  if (cancels(sample, reference, model)) {
    ratio.reference_slope = ratio.sample_slope;
    return ratio;
  }
  ratio.reference_slope = of_reference.slopes();
  const std::string owner = owner_of(instrument);
  add_beam_terms({ratio.terms, owner}, model, sensitivities(of_sample, model, model.sample_radius),
                 sensitivities(of_reference, model, model.reference_radius), 0.0);
  return ratio;
}

GeometryTerms absolute_geometry(const Geometry& sample, const InstrumentModel& instrument) {
  assert(instrument.overlap);
  const OverlapModel& model = *instrument.overlap;
  const Side side(sample, model, model.sample_radius);
  const double field_over_spot = model.field_radius.value / model.spot_radius.value;
  GeometryTerms found{.factor = std::exp(-side.log_h()) / (field_over_spot * field_over_spot),
                      .slope = side.slopes(),
                      .is_mixed = side.mode() == BeamMode::Mixed};
  const std::string owner = owner_of(instrument);
  add_beam_terms({found.terms, owner}, model, sensitivities(side, model, model.sample_radius), {},
                 2.0 * relative_u(model.spot_radius));
  return found;
}

}  // namespace gonio::calibration
