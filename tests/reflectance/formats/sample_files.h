#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// 0.1 sr^-1 everywhere but for one reading of 5 sr^-1, lit from 30 deg at phi = 0: views every 10 deg and 30 deg of
/// azimuth, four incidences. Every format must give the bright one back where it was.
inline MeasuredBrdf one_bright_reading(double theta_r_deg, double phi_r_deg) {
  MeasuredBrdf brdf;
  brdf.metadata.sample = "one bright reading";
  brdf.channels = {channel_at(550.0)};
  for (const double theta_i : {15.0, 30.0, 45.0, 60.0}) {
    for (double theta_r = 0.0; theta_r <= 80.0; theta_r += 10.0) {
      for (double phi_r = 0.0; phi_r < (theta_r > 0.0 ? 360.0 : 1.0); phi_r += 30.0) {
        const bool is_bright = theta_i == 30.0 && theta_r == theta_r_deg && phi_r == phi_r_deg;
        brdf.points.push_back({.theta_i_deg = theta_i,
                               .theta_r_deg = theta_r,
                               .phi_r_deg = phi_r,
                               .f_per_sr = is_bright ? 5.0 : 0.1,
                               .U_per_sr = 0.01,
                               .k = 2.0});
      }
    }
  }
  return brdf;
}
/// At (30, 30, 0): back where the light comes from.
inline MeasuredBrdf bright_retro() {
  return one_bright_reading(30.0, 0.0);
}
/// To one side, so that a file that turns azimuths the wrong way round shows it.
inline MeasuredBrdf bright_aside() {
  return one_bright_reading(50.0, 60.0);
}

inline const BrdfPoint& brightest(const MeasuredBrdf& brdf) {
  const BrdfPoint* found = brdf.points.data();
  for (const BrdfPoint& point : brdf.points)
    if (point.f_per_sr > found->f_per_sr) found = &point;
  return *found;
}

/// The arc between where a point looks and (theta_r, phi_r), lit from phi = 0 [deg].
inline double degrees_from_view(const BrdfPoint& point, double theta_r_deg, double phi_r_deg) {
  const Geometry apart{.theta_i = degrees(point.theta_r_deg),
                       .phi_i = degrees(point.phi_r_deg - point.phi_i_deg),
                       .theta_r = degrees(theta_r_deg),
                       .phi_r = degrees(phi_r_deg)};
  return in_degrees(phase_angle(apart));
}

inline const std::string& bytes_of(const Result<Export>& written, const std::string& suffix) {
  static const std::string kNone;
  for (const OutputFile& file : written.value().files)
    if (file.suffix == suffix) return file.bytes;
  return kNone;
}

}  // namespace gonio::formats
