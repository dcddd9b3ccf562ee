#include "calibration/mounting_term.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace gonio::calibration {
namespace {

using Vec = std::array<double, 3>;

Vec scaled(double k, const Vec& v) {
  return {k * v[0], k * v[1], k * v[2]};
}
Vec less(const Vec& a, const Vec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double inner(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double norm(const Vec& v) {
  return std::sqrt(inner(v, v));
}

Vec direction_of(Angle theta, Angle phi) {
  const double s = std::sin(theta.si());
  return {s * std::cos(phi.si()), s * std::sin(phi.si()), std::cos(theta.si())};
}
// Unit vectors of growing theta and of growing phi.
Vec along_theta(Angle theta, Angle phi) {
  const double c = std::cos(theta.si());
  return {c * std::cos(phi.si()), c * std::sin(phi.si()), -std::sin(theta.si())};
}
Vec along_phi(Angle phi) {
  return {-std::sin(phi.si()), std::cos(phi.si()), 0.0};
}

/// The turn that takes z to the leaning normal, about the horizontal axis across the lean.
class MountTurn {
 public:
  explicit MountTurn(const MountModel& mount)
      : angle_(std::hypot(mount.lean_0.value.si(), mount.lean_90.value.si())),
        axis_(angle_ == 0.0 ? Vec{1.0, 0.0, 0.0}
                            : Vec{-mount.lean_90.value.si() / angle_, mount.lean_0.value.si() / angle_, 0.0}) {}
  [[nodiscard]] Vec normal() const { return turned({0.0, 0.0, 1.0}, angle_); }
  [[nodiscard]] Vec in_surface(const Vec& lab) const { return turned(lab, -angle_); }

 private:
  // Rodrigues: v cos + (k x v) sin + k (k . v)(1 - cos).
  [[nodiscard]] Vec turned(const Vec& v, double angle) const {
    const Vec& k = axis_;
    const Vec across = {k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]};
    const double along = inner(k, v) * (1.0 - std::cos(angle));
    Vec out{};
    for (std::size_t n = 0; n < 3; ++n) out[n] = std::cos(angle) * v[n] + std::sin(angle) * across[n] + along * k[n];
    return out;
  }

  double angle_;
  Vec axis_;
};

Angle polar(const Vec& v) {
  return radians(std::atan2(std::hypot(v[0], v[1]), v[2]));
}
// At the pole the azimuth that it had: no direction has one of its own there.
Angle azimuth(const Vec& v, Angle otherwise) {
  if (std::hypot(v[0], v[1]) < 1e-12 * norm(v)) return otherwise;
  return otherwise + wrapped(radians(std::atan2(v[1], v[0])) - otherwise);
}

/// How a target's small error moves what its reading sees.
struct Shift {
  Vec i{};  ///< of the direction to the source, in its tangent plane
  Vec r{};
  double log_irradiance = 0.0;
};

// Half the difference of both sides: first order exactly, and nothing of the second.
Shift shift_of(const MountModel& one_sd, Length distance, const Geometry& g) {
  const auto seen = [&](double sign) {
    MountModel mount;
    mount.lean_0.value = sign * one_sd.lean_0.value;
    mount.lean_90.value = sign * one_sd.lean_90.value;
    mount.height.value = sign * one_sd.height.value;
    return view_on(mount, distance, g);
  };
  const SurfaceView up = seen(1.0);
  const SurfaceView down = seen(-1.0);
  const auto half = [](Angle theta_up, Angle phi_up, Angle theta_down, Angle phi_down) {
    return scaled(0.5, less(direction_of(theta_up, phi_up), direction_of(theta_down, phi_down)));
  };
  return {.i = half(up.geometry.theta_i, up.geometry.phi_i, down.geometry.theta_i, down.geometry.phi_i),
          .r = half(up.geometry.theta_r, up.geometry.phi_r, down.geometry.theta_r, down.geometry.phi_r),
          .log_irradiance = 0.5 * std::log(up.irradiance / down.irradiance)};
}

struct Effect {
  double value = 0.0;
  double unresolved = 0.0;
};

/// What a BRDF with these slopes changes by when its directions move so.
class SlopeEffect {
 public:
  SlopeEffect(const Geometry& g, const Shift& shift)
      : sines_{std::abs(std::sin(g.theta_i.si())), std::abs(std::sin(g.theta_r.si()))},
        theta_{inner(shift.i, along_theta(g.theta_i, g.phi_i)), inner(shift.r, along_theta(g.theta_r, g.phi_r))},
        across_{inner(shift.i, along_phi(g.phi_i)), inner(shift.r, along_phi(g.phi_r))} {}

  [[nodiscard]] double theta(std::size_t axis) const { return theta_[axis]; }

  [[nodiscard]] Effect of(const std::array<double, kDirectionAxes>& slope,
                          const std::array<double, kDirectionAxes>& unresolved,
                          const std::array<double, 2>& across_pole) const {
    Effect e;
    double variance = 0.0;
    double turn = 0.0;  // of phi_r - phi_i
    for (std::size_t a = 0; a < 2; ++a) {
      e.value += slope[a] * theta_[a];
      variance += unresolved[a] * unresolved[a] * theta_[a] * theta_[a];
      if (sines_[a] > kPole) {
        turn += (a == 1 ? 1.0 : -1.0) * across_[a] / sines_[a];
      } else {  // across the plane no neighbour says anything
        variance += across_pole[a] * across_pole[a] * across_[a] * across_[a];
      }
    }
    e.value += slope[2] * turn;
    variance += unresolved[2] * unresolved[2] * turn * turn;
    e.unresolved = std::sqrt(variance);
    return e;
  }

 private:
  static constexpr double kPole = 0.01;
  std::array<double, 2> sines_;
  std::array<double, 2> theta_;
  std::array<double, 2> across_;
};

// d ln f_ref across a pole: the standard is isotropic, and steepest towards the other direction.
std::array<double, 2> across_pole_of(const PairedPoint& point) {
  const auto& slope = point.standard.slope;
  const Geometry& g = point.reference.geometry;
  const double across = std::max(std::abs(slope[0]), std::abs(slope[1])) * std::abs(std::sin((g.phi_r - g.phi_i).si()));
  return {across, across};
}

struct MountError {
  std::string_view name;
  MountModel one_sd;
  double u = 0.0;
  std::string_view unit;
};

std::array<MountError, 3> errors_of(const MountModel& mount) {
  std::array<MountError, 3> errors;
  errors[0] = {.name = "lean to phi 0", .u = in_degrees(mount.lean_0.u), .unit = "deg"};
  errors[0].one_sd.lean_0.value = mount.lean_0.u;
  errors[1] = {.name = "lean to phi 90", .u = in_degrees(mount.lean_90.u), .unit = "deg"};
  errors[1].one_sd.lean_90.value = mount.lean_90.u;
  errors[2] = {.name = "height", .u = in_millimetres(mount.height.u), .unit = "mm"};
  errors[2].one_sd.height.value = mount.height.u;
  return errors;
}

}  // namespace

SurfaceView view_on(const MountModel& mount, Length source_distance, const Geometry& arms) {
  const MountTurn turn(mount);
  const Vec normal = turn.normal();
  const Vec to_source = direction_of(arms.theta_i, arms.phi_i);
  const Vec to_detector = direction_of(arms.theta_r, arms.phi_r);
  const double height = mount.height.value.si();
  const Vec seen = scaled(normal[2] * height / inner(normal, to_detector), to_detector);
  const Vec lit_from = less(scaled(source_distance.si(), to_source), seen);
  const Vec i = turn.in_surface(lit_from);
  const Vec r = turn.in_surface(to_detector);
  const double nearness = source_distance.si() / norm(lit_from);
  return {.geometry = {.theta_i = polar(i),
                       .phi_i = azimuth(i, arms.phi_i),
                       .theta_r = polar(r),
                       .phi_r = azimuth(r, arms.phi_r)},
          .irradiance = nearness * nearness};
}

void add_mounting_terms(const PairedPoint& point, const DirectionSlopes& slopes, const InstrumentModel& instrument,
                        TermList& terms) {
  if (!instrument.mounting) return;
  const MountingModel& mounting = *instrument.mounting;
  const auto add = [&](bool is_sample) {
    const MountModel& mount = is_sample ? mounting.sample : mounting.reference;
    const NormalisedReading& reading = is_sample ? point.sample : point.reference;
    const std::string_view target = is_sample ? "sample" : "reference";
    const std::string owner = mount.mounting.empty() ? "" : "mounting " + mount.mounting;
    std::int64_t number = is_sample ? 0 : 3;
    for (const MountError& error : errors_of(mount)) {
      ++number;
      if (error.u == 0.0) continue;
      const Shift shift = shift_of(error.one_sd, mounting.source_distance, reading.geometry);
      const SlopeEffect moved(reading.geometry, shift);
      const auto& log_slope = is_sample ? point.sample_log_slope : point.reference_log_slope;
      const double level = log_slope[0] * moved.theta(0) + log_slope[1] * moved.theta(1) + shift.log_irradiance;
      const Effect effect = is_sample ? moved.of(slopes.slope, slopes.unresolved, slopes.across_pole)
                                      : moved.of(point.standard.slope, {}, across_pole_of(point));
      const double per_sd = is_sample ? effect.value + point.value * level : -point.value * (effect.value + level);
      terms.shared({ComponentSource::Mounting, number}, error.u, error.unit, per_sd,
                   [&] { return fmt::format("{} of the {}", error.name, target); }, {.owner = owner});
      if (effect.unresolved > 0.0) {
        terms.shared({ComponentSource::UnresolvedMounting, number}, error.u, error.unit, effect.unresolved,
                     [&] { return fmt::format("{} of the {} through unresolved slopes", error.name, target); },
                     {.is_pattern_known = false});
      }
    }
  };
  add(true);
  if (point.mode != ReferenceMode::Absolute) add(false);
}

}  // namespace gonio::calibration
