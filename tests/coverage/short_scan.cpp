#include "tests/coverage/short_scan.h"

#include <algorithm>
#include <cmath>

namespace gonio::coverage {

using calibration::PlannedPoint;
using calibration::RawFrame;
using calibration::RawReading;
using calibration::ScanReadings;
using calibration::Target;

namespace {

constexpr double kMoveS = 2.0;  // of scene time, settling included
constexpr double kBetweenFramesS = 0.05;
constexpr double kMostOfFullScale = 0.6;  // what the sequencer exposes for
constexpr Angle kShadow = degrees(4.6);   // heads of 20 mm on arms of 500 mm: asin(40 / 500)

std::vector<double> ladder(const sim::DetectorSpec& detector) {
  std::vector<double> rungs;
  for (double t = detector.shortest_exposure_s; t <= detector.longest_exposure_s * 1.0001; t *= 2.0) rungs.push_back(t);
  return rungs;
}

}  // namespace

calibration::InstrumentModel ShortScan::stated_model(const sim::Scene& scene) const {
  constexpr double kRounding = 1.0 / 12.0;
  const sim::DetectorSpec& d = scene.detector;
  const sim::ToldSpec& told = scene.told;
  return {.detector = {.electrons_per_dn = d.electrons_per_dn,
                       .read_noise_dn = std::sqrt(d.read_noise_dn * d.read_noise_dn + kRounding),
                       .full_scale_dn = d.full_scale_dn(),
                       .exposure_offset_s = {.value = told.exposure_offset_s,
                                             .u = std::hypot(plan_.u_exposure_offset_s, told.u_exposure_offset_s)},
                       .u_linearity = told.u_linearity.value_or(d.u_linearity),
                       .u_dark_drift_dn_per_s = std::hypot(plan_.u_dark_drift_dn_per_s, told.u_dark_drift_dn_per_s)},
          .angles = {.u_zero_theta_i = told.u_zero_theta_i.value_or(scene.angles.u_zero_theta_i),
                     .u_zero_theta_r = told.u_zero_theta_r.value_or(scene.angles.u_zero_theta_r),
                     .u_zero_phi_r = told.u_zero_phi_r.value_or(scene.angles.u_zero_phi_r),
                     .u_repeat = told.u_repeat.value_or(scene.angles.u_repeat)},
          .lamp = {.u_after_monitor = told.u_after_monitor.value_or(scene.lamp.u_after_monitor),
                   .correlation_s = scene.lamp.correlation_s,
                   .u_reproducibility = told.u_reproducibility.value_or(scene.lamp.u_reproducibility)}};
}

std::vector<PlannedPoint> ShortScan::points_of(const Plan& plan) {
  std::vector<PlannedPoint> points;
  const auto is_known = [&](const Geometry& g) {
    return std::ranges::any_of(
        points, [&](const PlannedPoint& p) { return same_geometry(p.geometry, g, true, degrees(0.01)); });
  };
  for (const double theta_i : plan.theta_i_deg) {
    for (const double theta_r : plan.theta_r_deg) {
      for (const double phi_r : plan.phi_r_deg) {
        const Geometry g{
            .theta_i = degrees(theta_i), .phi_i = {}, .theta_r = degrees(theta_r), .phi_r = degrees(phi_r)};
        if (phase_angle(g) < kShadow || is_known(g)) continue;
        points.push_back(
            {.index = static_cast<std::int32_t>(points.size()), .geometry = g, .wavelength = plan.wavelength});
      }
    }
  }
  return points;
}

ScanReadings ShortScan::measure(const sim::ReadingLevel& instrument) {
  scan_ = {.isotropic = true, .points = points_, .readings = {}};
  // A key of its own: the truth draws nothing with this counter.
  constexpr std::uint64_t kOwnCounter = 1'000'000;
  chance_ = sim::Chance(instrument.scene().seed, sim::Purpose::Linearity, kOwnCounter);
  exposure_offset_s_ = plan_.u_exposure_offset_s * chance_.normal();
  visit_dark(instrument);
  for (std::size_t first = 0; first < points_.size(); first += plan_.block) {
    const std::size_t last = std::min(points_.size(), first + plan_.block);
    dark_drift_dn_per_s_ = plan_.u_dark_drift_dn_per_s * chance_.normal();
    for (const Target target : {Target::Sample, Target::Reference}) {
      for (std::size_t n = first; n < last; ++n) read_item(instrument, points_[n], target);
    }
    visit_dark(instrument);
  }
  return std::move(scan_);
}

RawReading& ShortScan::begin(Target target) {
  const auto number = static_cast<std::int64_t>(scan_.readings.size()) + 1;
  scan_.readings.push_back({.id = number,
                            .target = target,
                            .visit_id = number,
                            .wavelength = plan_.wavelength,
                            .at = Instant(seconds(now_s_))});
  return scan_.readings.back();
}

void ShortScan::visit_dark(const sim::ReadingLevel& instrument) {
  RawReading& reading = begin(Target::Dark);
  for (const double exposure_s : ladder(instrument.scene().detector)) {
    for (int k = 0; k < plan_.dark_frames; ++k) {
      reading.frames.push_back(
          expose(instrument, {.is_dark = true, .wavelength = plan_.wavelength, .move = moves_ + 1}, exposure_s));
    }
  }
}

double ShortScan::chosen_exposure_s(const sim::ReadingLevel& instrument, sim::ReadingRequest request) {
  const sim::DetectorSpec& detector = instrument.scene().detector;
  const std::vector<double> rungs = ladder(detector);
  const double probe_s = rungs[rungs.size() / 2];
  const RawFrame probe = expose(instrument, request, probe_s);
  if (probe.region.saturated > 0) return rungs.front();
  const double rate = std::max(0.1, probe.region.mean - detector.offset_dn) / probe_s;
  const auto above = std::ranges::find_if(
      rungs, [&](double t) { return detector.offset_dn + rate * t > kMostOfFullScale * detector.full_scale_dn(); });
  return above == rungs.begin() ? rungs.front() : *(above - 1);
}

void ShortScan::read_item(const sim::ReadingLevel& instrument, const PlannedPoint& point, Target target) {
  now_s_ += kMoveS;
  ++moves_;
  const sim::ReadingRequest request{.target = target == Target::Sample ? sim::Station::Sample : sim::Station::Reference,
                                    .encoders = point.geometry,
                                    .wavelength = point.wavelength,
                                    .move = moves_};
  const double exposure_s = chosen_exposure_s(instrument, request);
  RawReading& reading = begin(target);
  reading.point_index = point.index;
  for (int k = 0; k < plan_.frames; ++k) reading.frames.push_back(expose(instrument, request, exposure_s));
}

RawFrame ShortScan::expose(const sim::ReadingLevel& instrument, sim::ReadingRequest request, double exposure_s) {
  request.exposure = seconds(request.is_dark ? exposure_s : exposure_s + exposure_offset_s_);
  request.at_scene_s = now_s_;
  request.exposure_number = ++exposures_;
  const sim::ReadingAnswer answer = instrument.read(request);
  now_s_ += exposure_s + kBetweenFramesS;
  return {.region = {.n = answer.region.n,
                     .mean = answer.region.mean + (request.is_dark ? 0.0 : dark_drift_dn_per_s_ * exposure_s),
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

}  // namespace gonio::coverage
