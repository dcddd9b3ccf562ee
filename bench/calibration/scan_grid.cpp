#include "bench/calibration/scan_grid.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>

namespace gonio::bench {
namespace {

using namespace gonio::calibration;

constexpr int kDarkEvery = 1000;
constexpr int kVisitEvery = 2000;
constexpr double kDarkDn = 64.0;

double brdf(const Geometry& g) {
  return 0.2 + 0.05 * std::cos(g.theta_r.si()) * std::cos(g.phi_r.si());
}

class Grid {
 public:
  explicit Grid(int points) {
    scan_.readings.reserve(static_cast<std::size_t>(2 * points + 3 * points / kDarkEvery + 10));
    scan_.points.reserve(static_cast<std::size_t>(points));
    const int views = 90;
    const int turns = 100;
    for (int n = 0; n < points; ++n) {
      const int i = n / (views * turns);
      if (n % kDarkEvery == 0) add_dark();
      const Geometry g{.theta_i = degrees(0.3 + 0.6 * i),
                       .phi_i = {},
                       .theta_r = degrees(0.5 + 0.85 * ((n / turns) % views)),
                       .phi_r = degrees(1.8 * (n % turns))};
      scan_.points.push_back({.index = n, .geometry = g, .wavelength = nanometres(568.0)});
      if (n % kVisitEvery == 0) add(Target::Reference, scan_.points.front(), true);
      add(Target::Sample, scan_.points.back(), false);
      add(Target::Reference, scan_.points.back(), false);
    }
    add_dark();
  }
  [[nodiscard]] ScanReadings take() { return std::move(scan_); }

 private:
  RawReading& begin(Target target) {
    const auto number = static_cast<std::int64_t>(scan_.readings.size()) + 1;
    now_s_ += 1.0;
    scan_.readings.push_back({.id = number,
                              .target = target,
                              .point_index = {},
                              .visited_point = {},
                              .visit_id = number,
                              .wavelength = nanometres(568.0),
                              .at = Instant(seconds(now_s_)),
                              .frames = {}});
    return scan_.readings.back();
  }
  static RawFrame frame(double mean_dn, const Geometry& g) {
    RawFrame frame;
    frame.region = {.n = 450, .mean = mean_dn, .m2 = 20.0};
    frame.exposure_s = 0.016;
    frame.monitor_mean = 1.0;
    frame.monitor_se = 1e-4;
    frame.at_open = frame.at_close = g;
    return frame;
  }
  void add_dark() { begin(Target::Dark).frames.push_back(frame(kDarkDn, {})); }
  void add(Target target, const PlannedPoint& point, bool is_visit) {
    const double f = target == Target::Sample ? brdf(point.geometry) : 0.99 / std::numbers::pi;
    RawReading& reading = begin(target);
    (is_visit ? reading.visited_point : reading.point_index) = point.index;
    reading.frames.push_back(frame(kDarkDn + 5000.0 * f * std::cos(point.geometry.theta_i.si()), point.geometry));
  }

  ScanReadings scan_;
  double now_s_ = 0.0;
};

}  // namespace

ScanReadings scan_grid(int points) {
  return Grid(points).take();
}

ReferenceStandard grid_standard() {
  std::string values;
  for (int n = 0; n < 12 * 12 * 13; ++n) values += n == 0 ? "1.0" : ", 1.0";
  const std::string thetas = "[0, 8, 15, 22, 30, 38, 45, 52, 60, 68, 75, 85]";
  auto standard = ReferenceStandard::parse(
      "[standard]\nserial = \"SRT-99\"\n[certificate]\ndate = 2025-01-01\nexpires = 2030-01-01\ngeometry = \"8/h\"\n"
      "specular = \"included\"\ncoverage_factor = 2.0\nuncertainty_kind = \"absolute\"\n"
      "[[certificate.entries]]\nwavelength_nm = 568.0\nreflectance = 0.99\nuncertainty = 0.005\n[shape]\ntheta_i_deg "
      "= " +
          thetas + "\ntheta_r_deg = " + thetas +
          "\nphi_deg = [0, 15, 30, 45, 60, 75, 90, 105, 120, 135, 150, 165, 180]\nvalues = [" + values +
          "]\nu_integral = 0.001\n[[shape.modes]]\nname = \"limb\"\nkind = \"limb\"\nu = 0.01\n[[shape.modes]]\nname = "
          "\"forward\"\nkind = \"forward\"\nu = 0.005\n",
      "white.toml");
  if (!standard) {
    fmt::print("{}\n", describe(standard.error()));
    std::exit(1);
  }
  return std::move(standard).value();
}

InstrumentModel grid_instrument() {
  InstrumentModel model;
  model.detector = {.electrons_per_dn = 4.0,
                    .read_noise_dn = 1.5,
                    .exposure_offset_s = {.value = 0.0, .u = 1e-5},
                    .u_linearity = 0.002};
  model.angles = {.u_zero_theta_i = degrees(0.02),
                  .u_zero_theta_r = degrees(0.02),
                  .u_zero_phi_r = degrees(0.02),
                  .u_repeat = degrees(0.01)};
  model.lamp = {.u_after_monitor = 0.001, .u_reproducibility = 0.003};
  return model;
}

}  // namespace gonio::bench
