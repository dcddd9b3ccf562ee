#include "tests/coverage/short_scan.h"

#include <algorithm>
#include <cassert>
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
// A key of its own: the truth draws nothing with this counter.
constexpr std::uint64_t kOwnCounter = 1'000'000;

std::vector<double> ladder(const sim::DetectorSpec& detector) {
  std::vector<double> rungs;
  for (double t = detector.shortest_exposure_s; t <= detector.longest_exposure_s * 1.0001; t *= 2.0) rungs.push_back(t);
  return rungs;
}

}  // namespace

calibration::InstrumentModel ShortScan::stated_model(const sim::Scene& scene, const ScanPlan& plan) {
  constexpr double kRounding = 1.0 / 12.0;
  const sim::DetectorSpec& d = scene.detector;
  const sim::ToldSpec& told = scene.told;
  calibration::InstrumentModel model{
      .detector = {.electrons_per_dn = d.electrons_per_dn,
                   .read_noise_dn = std::sqrt(d.read_noise_dn * d.read_noise_dn + kRounding),
                   .full_scale_dn = d.full_scale_dn(),
                   .exposure_offset_s = {.value = told.exposure_offset_s, .u = told.u_exposure_offset_s},
                   .u_linearity = told.u_linearity.value_or(d.u_linearity),
                   .u_dark_drift_dn_per_s = std::hypot(plan.u_dark_drift_dn_per_s, told.u_dark_drift_dn_per_s)},
      .angles = {.u_zero_theta_i = told.u_zero_theta_i.value_or(scene.angles.u_zero_theta_i),
                 .u_zero_theta_r = told.u_zero_theta_r.value_or(scene.angles.u_zero_theta_r),
                 .u_zero_phi_r = told.u_zero_phi_r.value_or(scene.angles.u_zero_phi_r),
                 .u_repeat = told.u_repeat.value_or(scene.angles.u_repeat)},
      .lamp = {.u_after_monitor = told.u_after_monitor.value_or(scene.lamp.u_after_monitor),
               .correlation_s = scene.lamp.correlation_s,
               .u_reproducibility = told.u_reproducibility.value_or(scene.lamp.u_reproducibility)}};
  if (plan.detector == DetectorKind::Radiometer) {
    model.detector.full_scale_dn = 1.0;
    model.detector.u_linearity = plan.meter.u_linearity;
    model.detector.power =
        calibration::PowerModel{.noise = plan.meter.noise, .u_range = plan.meter.u_range, .u_zero = plan.meter.u_zero};
  }
  return model;
}

std::vector<PlannedPoint> ShortScan::points_of(const ScanPlan& plan) {
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
  scan_ = {};
  scan_.points = points_;
  scan_.reference_mode = plan_.reference_mode;
  chance_ = sim::Chance(instrument.scene().seed, sim::Purpose::Linearity, kOwnCounter);
  draw_meter(instrument.scene().seed);
  const auto begin_stretch = [&] {
    response_before_ = response();
    step_ = plan_.step * chance_.normal();
    const double stretch_s = static_cast<double>(2 * plan_.block) * kMoveS;
    step_at_s_ = now_s_ + chance_.uniform() * stretch_s;
  };
  visit_all(instrument);
  for (std::size_t first = 0; first < points_.size(); first += plan_.block) {
    const std::size_t last = std::min(points_.size(), first + plan_.block);
    dark_drift_dn_per_s_ = plan_.u_dark_drift_dn_per_s * chance_.normal();
    for (double& zero : range_zeros_) zero = plan_.meter.u_zero * chance_.normal();
    begin_stretch();
    for (const Target target : {Target::Sample, Target::Reference}) {
      if (target == Target::Reference && plan_.reference_mode != calibration::ReferenceMode::SameGeometry) continue;
      for (std::size_t n = first; n < last; ++n) read_item(instrument, points_[n], target);
    }
    visit_all(instrument);
  }
  return std::move(scan_);
}

void ShortScan::draw_meter(std::uint64_t seed) {
  if (plan_.detector != DetectorKind::Radiometer) return;
  sim::Chance chance(seed, sim::Purpose::RadiometerRange, kOwnCounter);
  range_gains_.clear();
  for (std::size_t r = 0; r < plan_.meter.ranges_w.size(); ++r) {
    range_gains_.push_back(1.0 + plan_.meter.u_range * chance.normal());
  }
  range_zeros_.assign(plan_.meter.ranges_w.size(), 0.0);
  meter_linearity_ = plan_.meter.u_linearity * chance.normal();
}

double ShortScan::response() const {
  return now_s_ < step_at_s_ ? response_before_ : response_before_ * (1.0 + step_);
}

RawReading& ShortScan::begin(Target target) {
  const auto number = static_cast<std::int64_t>(scan_.readings.size()) + 1;
  scan_.readings.push_back({.id = number,
                            .target = target,
                            .point_index = std::nullopt,
                            .visited_point = std::nullopt,
                            .visit_id = number,
                            .wavelength = plan_.wavelength,
                            .at = Instant(seconds(now_s_)),
                            .frames = {}});
  return scan_.readings.back();
}

void ShortScan::visit_dark(const sim::ReadingLevel& instrument) {
  RawReading& reading = begin(Target::Dark);
  const sim::ReadingRequest request{
      .is_dark = true, .encoders = {}, .wavelength = plan_.wavelength, .move = moves_ + 1};
  if (plan_.detector == DetectorKind::Radiometer) {
    for (std::size_t range = 0; range < plan_.meter.ranges_w.size(); ++range) {
      for (int k = 0; k < plan_.dark_frames; ++k) reading.frames.push_back(meter_power(instrument, request, range));
    }
    return;
  }
  for (const double exposure_s : ladder(instrument.scene().detector)) {
    for (int k = 0; k < plan_.dark_frames; ++k) reading.frames.push_back(expose(instrument, request, exposure_s));
  }
}

void ShortScan::visit_standard(const sim::ReadingLevel& instrument) {
  if (!plan_.visits) return;
  now_s_ += kMoveS;
  ++moves_;
  const auto from_0_45 = [](const PlannedPoint& p) {
    return std::abs(in_degrees(p.geometry.theta_i)) + std::abs(in_degrees(p.geometry.theta_r) - 45.0);
  };
  const PlannedPoint& point = *std::ranges::min_element(points_, {}, from_0_45);
  RawReading& reading = begin(Target::Reference);
  reading.visited_point = point.index;
  add_frames(
      instrument,
      {.target = sim::Station::Reference, .encoders = point.geometry, .wavelength = plan_.wavelength, .move = moves_},
      reading);
}

void ShortScan::visit_stray(const sim::ReadingLevel& instrument) {
  for (const Target target : {Target::Ambient, Target::Trap}) {
    if (!(target == Target::Ambient ? plan_.ambient_visits : plan_.trap_visits)) continue;
    now_s_ += kMoveS;
    ++moves_;
    RawReading& reading = begin(target);
    const sim::ReadingRequest request{.target = sim::Station::Trap,
                                      .is_ambient = target == Target::Ambient,
                                      .encoders = points_.front().geometry,
                                      .wavelength = plan_.wavelength,
                                      .move = moves_};
    const double exposure_s = ladder(instrument.scene().detector).back();
    for (int k = 0; k < plan_.frames; ++k) reading.frames.push_back(expose(instrument, request, exposure_s));
  }
}

void ShortScan::visit_all(const sim::ReadingLevel& instrument) {
  visit_dark(instrument);
  visit_standard(instrument);
  visit_stray(instrument);
}

double ShortScan::chosen_exposure_s(const sim::ReadingLevel& instrument, const sim::ReadingRequest& request) {
  if (plan_.exposure_s > 0.0) return plan_.exposure_s;
  const sim::DetectorSpec& detector = instrument.scene().detector;
  const std::vector<double> rungs = ladder(detector);
  const double probe_s = rungs[rungs.size() / 3];  // bright samples must not saturate it
  const RawFrame probe = expose(instrument, request, probe_s);
  if (probe.region.saturated > 0) return rungs.front();
  const double rate = std::max(0.1, probe.region.mean - detector.offset_dn) / probe_s;
  const auto above = std::ranges::find_if(
      rungs, [&](double t) { return detector.offset_dn + rate * t > kMostOfFullScale * detector.full_scale_dn(); });
  return above == rungs.begin() ? rungs.front() : *(above - 1);
}

std::size_t ShortScan::chosen_range(const sim::ReadingLevel& instrument, const sim::ReadingRequest& request) {
  const std::vector<double>& ranges = plan_.meter.ranges_w;
  const RawFrame probe = meter_power(instrument, request, ranges.size() - 1);
  const auto holds = std::ranges::find_if(ranges, [&](double range) { return range >= probe.power->mean_w; });
  return holds == ranges.end() ? ranges.size() - 1 : static_cast<std::size_t>(holds - ranges.begin());
}

void ShortScan::read_item(const sim::ReadingLevel& instrument, const PlannedPoint& point, Target target) {
  now_s_ += kMoveS;
  ++moves_;
  RawReading& reading = begin(target);
  reading.point_index = point.index;
  add_frames(instrument,
             {.target = target == Target::Sample ? sim::Station::Sample : sim::Station::Reference,
              .encoders = point.geometry,
              .wavelength = point.wavelength,
              .move = moves_},
             reading);
}

void ShortScan::add_frames(const sim::ReadingLevel& instrument, const sim::ReadingRequest& request,
                           RawReading& reading) {
  if (plan_.detector == DetectorKind::Radiometer) {
    reading.frames.push_back(meter_power(instrument, request, chosen_range(instrument, request)));
    return;
  }
  const double exposure_s = chosen_exposure_s(instrument, request);
  reading.at = Instant(seconds(now_s_));
  for (int k = 0; k < plan_.frames; ++k) reading.frames.push_back(expose(instrument, request, exposure_s));
}

sim::MonitorReading ShortScan::monitor(const sim::ReadingLevel& instrument, const sim::ReadingRequest& request) {
  if (plan_.monitor_is_blind || request.is_dark) return {.mean = 1.0, .standard_error = 0.0, .samples = 4};
  return instrument.monitor(request);
}

calibration::RegionMoments ShortScan::statistics(const sim::ReadingLevel& instrument,
                                                 const sim::ReadingRequest& request) {
  const sim::Scene& scene = instrument.scene();
  const sim::Exposure exposure = instrument.expose(request);
  if (plan_.detector == DetectorKind::Frames) {
    const sim::Aperture a = sim::aperture_of(scene.detector);
    if (!reducer_) {
      auto made = calibration::FrameReducer::prepare(scene.detector.width_px, scene.detector.height_px,
                                                     static_cast<std::uint16_t>(scene.detector.full_scale_dn()),
                                                     {a.centre_x_px, a.centre_y_px, a.radius_px});
      assert(made);
      reducer_ = std::move(*made);
    }
    const auto pixels = sim::render_frame(scene.detector, exposure, scene.seed);
    auto reduced = reducer_->reduce(pixels, in_seconds(request.exposure), 0.0);
    assert(reduced);
    return reduced->raw;
  }
  const sim::RegionStatistics s = sim::draw_region(scene.detector, exposure, scene.seed);
  return {.n = s.n, .mean = s.mean, .m2 = s.m2, .m3 = s.m3, .m4 = s.m4, .saturated = s.saturated};
}

RawFrame ShortScan::expose(const sim::ReadingLevel& instrument, sim::ReadingRequest request, double exposure_s) {
  // The response takes part as light for longer: dark charge is too little to notice.
  request.exposure = seconds(request.is_dark ? exposure_s : exposure_s * response());
  request.at_scene_s = now_s_;
  request.exposure_number = ++exposures_;
  calibration::RegionMoments region = statistics(instrument, request);
  const sim::MonitorReading lamp = monitor(instrument, request);
  if (!request.is_dark) region.mean += dark_drift_dn_per_s_ * exposure_s;
  now_s_ += exposure_s + kBetweenFramesS;
  return {.region = region,
          .reduced = std::nullopt,
          .exposure_s = exposure_s,
          .monitor_mean = lamp.mean,
          .monitor_se = lamp.standard_error,
          .at_open = request.encoders,
          .at_close = request.encoders,
          .power = std::nullopt};
}

RawFrame ShortScan::meter_power(const sim::ReadingLevel& instrument, sim::ReadingRequest request, std::size_t range) {
  const MeterSpec& meter = plan_.meter;
  const double range_w = meter.ranges_w[range];
  const double length_s = meter.samples * meter.average_s;
  request.exposure = seconds(length_s);
  request.at_scene_s = now_s_;
  request.exposure_number = ++exposures_;
  const double light_w =
      request.is_dark ? 0.0 : meter.w_per_electron_rate * instrument.expose(request).light_electrons / length_s;
  sim::Chance noise(instrument.scene().seed, sim::Purpose::Radiometer, request.exposure_number);
  const double u_w = meter.noise * range_w / std::sqrt(static_cast<double>(meter.samples));
  const double bent = light_w * (1.0 + meter_linearity_ * light_w / range_w) * range_gains_[range];
  const double zero_w = request.is_dark ? 0.0 : range_zeros_[range] * range_w;
  const sim::MonitorReading lamp = monitor(instrument, request);
  now_s_ += length_s + kBetweenFramesS;
  return {.region = {},
          .reduced = std::nullopt,
          .exposure_s = 0.0,
          .monitor_mean = lamp.mean,
          .monitor_se = lamp.standard_error,
          .at_open = request.encoders,
          .at_close = request.encoders,
          .power = calibration::PowerReading{.mean_w = bent + zero_w + u_w * noise.normal(),
                                             .standard_error_w = u_w,
                                             .samples = meter.samples,
                                             .averages = 1,
                                             .range_w = range_w,
                                             .wavelength = request.wavelength}};
}

}  // namespace gonio::coverage
