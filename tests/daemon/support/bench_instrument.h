#pragma once

#include "daemon/config/instrument.h"
#include "protocol/api/plan.h"

namespace gonio::daemon::test {

/// An instrument made by hand, for tests that read no file: quick axes, one filter at 568 nm, heads of 20 mm on arms of
/// 500 and 600 mm (keep-out asin(40/500) = 4.588 deg), exposures 1 ms * 2^n up to 64 ms.
[[nodiscard]] inline Instrument bench_instrument() {
  using stage::Axis;
  Instrument instrument;
  instrument.name = "bench";
  instrument.text = "# bench";
  instrument.sha256 = "0123";
  instrument.stage.registers = stage::own_register_map();
  const auto put = [&instrument](Axis axis, double low, double high, double speed, double window) {
    instrument.stage.axes[stage::index_of(axis)] = drivers::AxisConfig{.low = low,
                                                                       .high = high,
                                                                       .speed = speed,
                                                                       .acceleration = 2.0 * speed,
                                                                       .settle = std::chrono::milliseconds(20),
                                                                       .window = window};
  };
  put(Axis::ThetaI, 0.0, 85.0, 20.0, 0.01);
  put(Axis::ThetaR, 0.0, 85.0, 20.0, 0.01);
  put(Axis::PhiR, -180.0, 180.0, 60.0, 0.01);
  put(Axis::PhiI, -180.0, 180.0, 60.0, 0.01);
  put(Axis::Carriage, -1.0, 250.0, 100.0, 0.05);
  put(Axis::FilterWheel, 0.0, 6.0, 2.0, 0.05);
  instrument.stage.heartbeat_timeout = std::chrono::seconds(2);
  instrument.carriage = {.sample = millimetres(0.0), .reference = millimetres(120.0), .trap = millimetres(240.0)};
  instrument.filters = {Filter{.slot = 1, .centroid = nanometres(568.0), .fwhm = nanometres(10.0)}};
  instrument.shadow = {.detector_head_radius = millimetres(20.0),
                       .source_head_radius = millimetres(20.0),
                       .detector_arm = millimetres(500.0),
                       .source_arm = millimetres(600.0)};
  instrument.detector.shortest_exposure = std::chrono::milliseconds(1);
  instrument.detector.longest_exposure = std::chrono::milliseconds(64);
  instrument.detector.frames_at_most = 16;
  instrument.lamp = {.low = 0.2, .high = 5.0};
  instrument.model.detector.electrons_per_dn = 4.0;
  instrument.model.detector.read_noise_dn = 1.5;
  instrument.model.detector.full_scale_dn = 4095.0;
  return instrument;
}

/// A plan for it: the product of the given angles (deg) at 568 nm, with phi_i = 0.
[[nodiscard]] inline api::Plan bench_plan(const std::vector<double>& theta_i_deg,
                                          const std::vector<double>& theta_r_deg,
                                          const std::vector<double>& phi_r_deg) {
  api::Plan plan;
  plan.name = "bench plan";
  plan.sample = "plate 7";
  for (const double a : theta_i_deg) plan.theta_i.push_back(degrees(a));
  for (const double a : theta_r_deg) plan.theta_r.push_back(degrees(a));
  for (const double a : phi_r_deg) plan.phi_r.push_back(degrees(a));
  plan.phi_i = {degrees(0.0)};
  plan.wavelengths = {nanometres(568.0)};
  plan.target_snr = 300.0;
  plan.max_time = std::chrono::seconds(1);
  plan.reference_standard = "SRT-1";
  plan.block = std::chrono::seconds(60);
  plan.dark_every = std::chrono::seconds(300);
  return plan;
}

}  // namespace gonio::daemon::test
