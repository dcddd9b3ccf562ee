#include "reflectance/formats/measured_brdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace gonio::formats {
namespace {

using reflectance::TableSymmetry;

constexpr std::size_t kMostFlags = 32;

Error point_error(const std::string& file, std::size_t index, std::string_view field, std::string seen,
                  std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("take point {} (from 0)", index),
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{file, 0, std::string(field)}};
}

Error file_error(const std::string& file, std::string field, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "take the BRDF",
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{file, 0, std::move(field)}};
}

struct NamedValue {
  std::string_view name;
  double value;
  double least;
  double most;
};

std::array<NamedValue, 8> numbers_of(const BrdfPoint& p) {
  constexpr double kAny = 1e300;
  return {{{"theta_i_deg", p.theta_i_deg, -90.0, 90.0},
           {"phi_i_deg", p.phi_i_deg, -kAny, kAny},
           {"theta_r_deg", p.theta_r_deg, -90.0, 90.0},
           {"phi_r_deg", p.phi_r_deg, -kAny, kAny},
           {"f_per_sr", p.f_per_sr, -kAny, kAny},
           {"U_per_sr", p.U_per_sr, 0.0, kAny},
           {"k", p.k, 0.0, kAny},
           {"u_shared_per_sr", p.u_shared_per_sr, 0.0, kAny}}};
}

Result<void> check_point(const MeasuredBrdf& brdf, std::size_t index, const std::string& file) {
  const BrdfPoint& p = brdf.points[index];
  for (const NamedValue& number : numbers_of(p)) {
    if (number.value >= number.least && number.value <= number.most) continue;
    return failure(point_error(file, index, number.name, fmt::format("{}", number.value),
                               fmt::format("{:.6g} to {:.6g}", number.least, number.most)));
  }
  if (p.channel >= brdf.channels.size())
    return failure(point_error(file, index, "channel", fmt::format("channel {}", p.channel),
                               fmt::format("below {}", brdf.channels.size())));
  const bool has_unnamed_flag =
      brdf.flag_names.size() < kMostFlags && (p.flags >> static_cast<unsigned>(brdf.flag_names.size())) != 0;
  if (!has_unnamed_flag) return {};
  return failure(point_error(file, index, "flags", fmt::format("bits {:#x}", p.flags),
                             fmt::format("{} names", brdf.flag_names.size())));
}

}  // namespace

Channel channel_at(double wavelength_nm) {
  return {.name = fmt::format("{}nm", wavelength_nm), .wavelength_nm = wavelength_nm};
}

Geometry geometry_of(const BrdfPoint& p) {
  return {.theta_i = degrees(p.theta_i_deg),
          .phi_i = degrees(p.phi_i_deg),
          .theta_r = degrees(p.theta_r_deg),
          .phi_r = degrees(p.phi_r_deg)};
}

reflectance::DirectionPair directions_of(const BrdfPoint& p) {
  const Geometry g = geometry_of(p);
  return {.i = reflectance::incident_direction(g), .r = reflectance::reflected_direction(g)};
}

double plain_azimuth_deg(double phi_deg) {
  constexpr double kTurn = 360.0;
  if (phi_deg >= 0.0 && phi_deg < kTurn) return phi_deg;
  const double wrapped = std::fmod(phi_deg, kTurn);
  const double positive = wrapped < 0.0 ? wrapped + kTurn : wrapped;
  return positive < kTurn ? positive : 0.0;  // a tiny negative angle rounds to the full turn
}

BrdfPoint in_plain_ranges(const BrdfPoint& point) {
  constexpr double kHalfTurn = 180.0;
  BrdfPoint plain = point;
  const auto turn = [](double& theta, double& phi) {
    if (theta < 0.0) phi += kHalfTurn;
    theta = std::abs(theta);
    phi = plain_azimuth_deg(phi);
  };
  turn(plain.theta_i_deg, plain.phi_i_deg);
  turn(plain.theta_r_deg, plain.phi_r_deg);
  return plain;
}

double standard_u_per_sr(const BrdfPoint& point) {
  return point.k > 0.0 ? point.U_per_sr / point.k : point.U_per_sr;
}

Result<void> check(const MeasuredBrdf& brdf, const std::string& file) {
  if (brdf.points.empty()) return failure(file_error(file, "points", "no points", "at least one"));
  if (brdf.points.size() > kMostPoints)
    return failure(file_error(file, "points", fmt::format("{} points", brdf.points.size()),
                              fmt::format("at most {}", kMostPoints)));
  if (brdf.flag_names.size() > kMostFlags)
    return failure(file_error(file, "flags", fmt::format("{} flags", brdf.flag_names.size()), "at most 32"));
  for (const Channel& channel : brdf.channels) {
    if (std::isfinite(channel.wavelength_nm) && channel.wavelength_nm >= 0.0) continue;
    return failure(file_error(file, "wavelength_nm", fmt::format("{}", channel.wavelength_nm), "finite, at least 0"));
  }
  for (std::size_t n = 0; n < brdf.points.size(); ++n) GONIO_TRY(check_point(brdf, n, file));
  return {};
}

TableSymmetry symmetry_of(const MeasuredBrdf& brdf) {
  if (brdf.metadata.symmetry) return *brdf.metadata.symmetry;
  constexpr double kSame = 1e-6;  // rad
  bool is_left = false;
  bool is_right = false;
  std::optional<double> phi_i;
  for (const BrdfPoint& p : brdf.points) {
    const reflectance::DirectionPair d = directions_of(p);
    if (d.i.sin_theta() > kSame) {
      const double phi = d.i.phi().si();
      if (phi_i && std::abs(wrapped(radians(phi - *phi_i)).si()) > kSame) return TableSymmetry::Anisotropic;
      phi_i = phi;
    }
    const double aside = std::sin(reflectance::azimuth_difference(d.i, d.r).si()) * d.r.sin_theta();
    is_left = is_left || aside > kSame;
    is_right = is_right || aside < -kSame;
  }
  return is_left && is_right ? TableSymmetry::Turn : TableSymmetry::Isotropic;
}

}  // namespace gonio::formats
