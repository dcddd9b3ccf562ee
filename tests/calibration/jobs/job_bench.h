#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "sim/devices/reading_level.h"
#include "sim/scene/scene.h"

namespace gonio::calibration::test {

/// Readings of the simulator without a stage, as a job's scan stores them: darks at the start, after every tenth item
/// and at the end.
class JobBench {
 public:
  explicit JobBench(const sim::ReadingLevel& instrument, std::vector<double> dark_exposures_s)
      : instrument_(instrument), dark_exposures_s_(std::move(dark_exposures_s)) {
    dark();
  }

  /// One item: an exposure each, in this order. Saturated ones are left out, as the sequencer does.
  void item(std::int32_t point, const Geometry& g, Target target, const std::vector<double>& exposures_s) {
    constexpr double kMoveS = 2.0;
    now_s_ += kMoveS;
    ++moves_;
    RawReading reading = begin(target);
    reading.point_index = point;
    for (const double exposure_s : exposures_s) {
      const sim::ReadingRequest request{
          .target = station_of(target, g), .encoders = g, .wavelength = kWavelength, .move = moves_};
      RawFrame frame = expose(request, exposure_s);
      if (frame.region.saturated == 0) reading.frames.push_back(frame);
    }
    scan_.readings.push_back(std::move(reading));
    constexpr std::int64_t kItemsBetweenDarks = 10;
    if (++items_ % kItemsBetweenDarks == 0) dark();
  }
  std::int32_t plan(const Geometry& g) {
    const auto index = static_cast<std::int32_t>(scan_.points.size());
    scan_.points.push_back({.index = index, .geometry = g, .wavelength = kWavelength});
    return index;
  }
  [[nodiscard]] ScanReadings finish() {
    dark();
    return std::move(scan_);
  }

  static inline const Wavelength kWavelength = nanometres(568.0);

 private:
  // Below the surface the detector looks into the source, past all targets.
  static sim::Station station_of(Target target, const Geometry& g) {
    if (g.theta_r > degrees(90.0)) return sim::Station::Open;
    return target == Target::Sample ? sim::Station::Sample : sim::Station::Reference;
  }
  RawReading begin(Target target) {
    ++readings_;
    return {.id = readings_,
            .target = target,
            .visit_id = readings_,
            .wavelength = kWavelength,
            .at = Instant(seconds(now_s_))};
  }
  void dark() {
    constexpr int kFrames = 4;
    RawReading reading = begin(Target::Dark);
    for (const double exposure_s : dark_exposures_s_) {
      for (int k = 0; k < kFrames; ++k) {
        reading.frames.push_back(expose({.is_dark = true, .wavelength = kWavelength, .move = moves_ + 1}, exposure_s));
      }
    }
    scan_.readings.push_back(std::move(reading));
  }
  RawFrame expose(sim::ReadingRequest request, double exposure_s) {
    request.exposure = seconds(exposure_s);
    request.at_scene_s = now_s_;
    request.exposure_number = ++exposures_;
    const sim::ReadingAnswer answer = instrument_.read(request);
    now_s_ += exposure_s + 0.05;
    return {.region = {.n = answer.region.n,
                       .mean = answer.region.mean,
                       .m2 = answer.region.m2,
                       .m3 = answer.region.m3,
                       .m4 = answer.region.m4,
                       .saturated = answer.region.saturated},
            .exposure_s = exposure_s,
            .monitor_mean = answer.monitor.mean,
            .monitor_se = answer.monitor.standard_error,
            .at_open = request.encoders,
            .at_close = request.encoders};
  }

  const sim::ReadingLevel& instrument_;
  std::vector<double> dark_exposures_s_;
  ScanReadings scan_;
  double now_s_ = 0.0;
  std::uint64_t exposures_ = 0;
  std::uint64_t moves_ = 0;
  std::int64_t readings_ = 0;
  std::int64_t items_ = 0;
};

/// What a daemon is told of a scene's detector, arms and lamp; time scale 1.
[[nodiscard]] inline InstrumentModel told_model(const sim::Scene& scene) {
  constexpr double kRounding = 1.0 / 12.0;
  const sim::DetectorSpec& d = scene.detector;
  return {.detector = {.electrons_per_dn = d.electrons_per_dn,
                       .read_noise_dn = std::sqrt(d.read_noise_dn * d.read_noise_dn + kRounding),
                       .full_scale_dn = d.full_scale_dn(),
                       .u_linearity = d.u_linearity},
          .angles = {.u_zero_theta_i = scene.angles.u_zero_theta_i,
                     .u_zero_theta_r = scene.angles.u_zero_theta_r,
                     .u_zero_phi_r = scene.angles.u_zero_phi_r,
                     .u_repeat = scene.angles.u_repeat},
          .lamp = {.u_after_monitor = scene.lamp.u_after_monitor,
                   .correlation_s = scene.lamp.correlation_s,
                   .u_reproducibility = scene.lamp.u_reproducibility}};
}

}  // namespace gonio::calibration::test
