#pragma once

#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// Writes the readings of a scan as an instrument without noise would have stored them.
class ScanBuilder {
 public:
  static constexpr double kDarkDn = 64.0;
  static constexpr std::uint32_t kPixels = 100;

  explicit ScanBuilder(std::vector<double> rungs_s) : rungs_s_(std::move(rungs_s)) {}

  std::int32_t add_point(const Geometry& g, Wavelength wavelength = nanometres(568.0)) {
    const auto index = static_cast<std::int32_t>(scan_.points.size());
    scan_.points.push_back({.index = index, .geometry = g, .wavelength = wavelength});
    return index;
  }

  /// One frame at each rung.
  RawReading& add_dark(double at_s, double level_dn = kDarkDn) {
    RawReading& reading = add(Target::Dark, at_s);
    for (const double exposure_s : rungs_s_) reading.frames.push_back(frame(exposure_s, level_dn, 1.0, {}));
    return reading;
  }

  /// One frame of `net_dn` above the dark, at the planned directions.
  RawReading& add_item(Target target, std::int32_t point, double at_s, double exposure_s, double net_dn,
                       double monitor = 1.0) {
    RawReading& reading = add(target, at_s);
    reading.point_index = point;
    reading.wavelength = scan_.points[static_cast<std::size_t>(point)].wavelength;
    reading.frames.push_back(
        frame(exposure_s, kDarkDn + net_dn, monitor, scan_.points[static_cast<std::size_t>(point)].geometry));
    return reading;
  }

  [[nodiscard]] ScanReadings& scan() { return scan_; }

  static Instant at(double s) { return Instant(seconds(s)); }

 private:
  RawReading& add(Target target, double at_s) {
    scan_.readings.push_back({.id = static_cast<std::int64_t>(scan_.readings.size()) + 1,
                              .target = target,
                              .visit_id = static_cast<std::int64_t>(scan_.readings.size()) + 1,
                              .at = at(at_s)});
    return scan_.readings.back();
  }

  static RawFrame frame(double exposure_s, double mean_dn, double monitor, const Geometry& g) {
    return {.region = {.n = kPixels, .mean = mean_dn},
            .exposure_s = exposure_s,
            .monitor_mean = monitor,
            .at_open = g,
            .at_close = g};
  }

  std::vector<double> rungs_s_;
  ScanReadings scan_;
};

inline Geometry directions(double theta_i_deg, double theta_r_deg, double phi_r_deg) {
  return {.theta_i = degrees(theta_i_deg), .phi_i = {}, .theta_r = degrees(theta_r_deg), .phi_r = degrees(phi_r_deg)};
}

}  // namespace gonio::calibration
