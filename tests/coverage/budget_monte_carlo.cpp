#include "tests/coverage/budget_monte_carlo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <thread>

#include "calibration/calibrate.h"
#include "sim/optics/slow_wander.h"
#include "sim/scene/spectralon_shape.h"
#include "sim/scene/truth.h"

namespace gonio::coverage {
namespace {

using calibration::CalibratedScan;
using calibration::RawFrame;
using calibration::RawReading;
using calibration::ScanReadings;
using calibration::Target;

const UtcTime kDayOfBudget{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};
constexpr auto kOwnPurpose = static_cast<sim::Purpose>(1001);

// Components whose input is disturbed below; all others are drawn from what the budget states.
bool is_carried_by_inputs(std::string_view name) {
  constexpr std::array<std::string_view, 19> kCarried = {
      "noise of",        "monitor noise",     "reproducibility of", "angle repeatability", "certificate",
      "shape mode",      "shape integral",    "zero theta_i",       "zero theta_r",        "zero phi_r",
      "exposure offset", "linearity",         "lamp after",         "dark visit",          "dark drift",
      "reference",       "gain of the range", "ambient visit",      "trap visit"};
  if (name.find("unresolved") != std::string_view::npos) return false;
  if (name.starts_with("zero ") && name.find("in the range") != std::string_view::npos) return true;
  return std::ranges::any_of(kCarried, [&](std::string_view start) { return name.starts_with(start); });
}

/// What one draw makes wrong with the whole scan.
struct SharedDraw {
  double certificate = 0.0, integral = 0.0;  ///< relative
  std::vector<double> modes;                 ///< amplitudes
  Angle zero_theta_i, zero_theta_r, zero_phi_r;
  double offset_s = 0.0;
  double linearity = 0.0;
  std::vector<double> curve;  ///< of the fitted coefficients
  std::vector<double> range_gains;
};

// Draws with this covariance [n][n], by Cholesky's factor; a variance of 0 draws 0.
std::vector<double> draw_joint(const std::vector<double>& covariance, sim::Chance& chance) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(covariance.size()))));
  std::vector<double> factor(n * n, 0.0), normals(n), drawn(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = covariance[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= factor[i * n + k] * factor[j * n + k];
      const double pivot = factor[j * n + j];
      factor[i * n + j] = i == j ? std::sqrt(std::max(0.0, sum)) : pivot > 0.0 ? sum / pivot : 0.0;
    }
    normals[i] = chance.normal();
    for (std::size_t k = 0; k <= i; ++k) drawn[i] += factor[i * n + k] * normals[k];
  }
  return drawn;
}

// DN/s above the dark that readings have beside the light of their target: what the trap shows, or else a closed
// source.
double background_rate(const ScanReadings& measured, const sim::DetectorSpec& detector) {
  double rate = 0.0;
  for (const Target target : {Target::Ambient, Target::Trap}) {
    double net = 0.0, exposure_s = 0.0;
    for (const RawReading& reading : measured.readings) {
      if (reading.target != target) continue;
      for (const RawFrame& frame : reading.frames) {
        net += frame.region.mean - detector.offset_dn - detector.dark_dn_per_s * frame.exposure_s;
        exposure_s += frame.exposure_s;
      }
    }
    if (exposure_s > 0.0) rate = net / exposure_s;
  }
  return rate;
}

class Disturber {
 public:
  Disturber(const PreparedScene& prepared, const sim::Truth& truth, const ScanReadings& measured)
      : scene_(prepared.base),
        plan_(prepared.scene.plan),
        told_(prepared.told),
        truth_(truth),
        measured_(measured),
        background_dn_per_s_(background_rate(measured, prepared.base.detector)) {
    const sim::SpectralonShape shape;
    for (const sim::ShapeMode& mode : scene_.reference.modes) {
      const std::vector<sim::ShapeMode> one = {mode};
      const std::vector<double> unit = {1.0};
      // The factor is 1 + M: what it adds to the integral of the shape, which is 1, is the mode's mean.
      mode_means_.push_back(
          sim::integral_at_8_degrees([&](const Geometry& g) { return shape(g) * sim::mode_factor(g, one, unit); }) -
          1.0);
    }
  }

  [[nodiscard]] ScanReadings draw(std::uint64_t seed) const {
    sim::Chance chance(seed, kOwnPurpose);
    const SharedDraw shared = draw_shared(chance);
    const sim::SlowWander lamp(seed, sim::Purpose::MonitorDrift, told_.lamp.correlation_s);
    ScanReadings readings = measured_;
    double dark_drift = 0.0;
    std::vector<double> range_zeros(plan_.meter.ranges_w.size(), 0.0);
    for (RawReading& reading : readings.readings) {
      if (reading.target == Target::Dark) {
        dark_drift = told_.detector.u_dark_drift_dn_per_s * chance.normal();
        for (double& zero : range_zeros) zero = plan_.meter.u_zero * chance.normal();
      }
      const bool is_target = reading.target == Target::Sample || reading.target == Target::Reference;
      const double light = is_target ? factor(reading, shared, chance) : 1.0;
      const double monitor =
          1.0 + lamp.at(in_seconds(reading.at.time_since_epoch()), told_.lamp.u_after_monitor / std::sqrt(2.0));
      const double scatter = scatter_of(reading);
      for (RawFrame& frame : reading.frames) {
        if (reading.target != Target::Dark) {
          frame.monitor_mean = frame.monitor_mean * monitor + frame.monitor_se * chance.normal();
        }
        if (frame.power)
          disturb_power(frame, reading.target, light, shared, range_zeros, chance);
        else
          disturb_frame(frame, reading.target, light, shared, dark_drift, scatter, chance);
      }
    }
    return readings;
  }

 private:
  [[nodiscard]] SharedDraw draw_shared(sim::Chance& chance) const {
    const auto certificate = sim::certificate_at(scene_.reference, plan_.wavelength);
    SharedDraw d{.certificate = certificate.u / certificate.value * chance.normal(),
                 .integral = scene_.reference.u_integral * chance.normal(),
                 .modes = {},
                 .zero_theta_i = told_.angles.u_zero_theta_i * chance.normal(),
                 .zero_theta_r = told_.angles.u_zero_theta_r * chance.normal(),
                 .zero_phi_r = told_.angles.u_zero_phi_r * chance.normal(),
                 .offset_s = told_.detector.exposure_offset_s.u * chance.normal(),
                 .linearity = told_.detector.u_linearity * chance.normal(),
                 .curve = draw_joint(told_.detector.linearity.covariance, chance),
                 .range_gains = {}};
    if (!d.curve.empty()) {  // its last is the exposure offset
      d.offset_s = d.curve.back();
      d.curve.pop_back();
    }
    for (const sim::ShapeMode& mode : scene_.reference.modes) d.modes.push_back(mode.u * chance.normal());
    for (std::size_t r = 0; r < plan_.meter.ranges_w.size(); ++r) {
      d.range_gains.push_back(1.0 + plan_.meter.u_range * chance.normal());
    }
    return d;
  }

  // What the light of a reading is multiplied by: the directions are others than the encoders say, the reference is
  // another than its papers say, the target was put down anew.
  [[nodiscard]] double factor(const RawReading& reading, const SharedDraw& d, sim::Chance& chance) const {
    const Geometry at = reading.frames.front().at_open;
    const Angle repeat = told_.angles.u_repeat;
    const Geometry turned = sim::folded({.theta_i = at.theta_i + d.zero_theta_i + repeat * chance.normal(),
                                         .phi_i = at.phi_i + repeat * chance.normal(),
                                         .theta_r = at.theta_r + d.zero_theta_r + repeat * chance.normal(),
                                         .phi_r = at.phi_r + d.zero_phi_r + repeat * chance.normal()});
    const double placing = 1.0 + told_.lamp.u_reproducibility * chance.normal();
    const auto signal = [&](const Geometry& g) {
      const Brdf f = reading.target == Target::Sample ? truth_.sample(g) : truth_.reference(g, plan_.wavelength);
      return f.si() * std::cos(g.theta_i.si());
    };
    const double light = placing * signal(turned) / signal(sim::folded(at));
    return reading.target == Target::Sample ? light : light * paper_factor(turned, d);
  }

  [[nodiscard]] double paper_factor(const Geometry& g, const SharedDraw& d) const {
    double shape = sim::mode_factor(g, scene_.reference.modes, d.modes);
    for (std::size_t k = 0; k < d.modes.size(); ++k) shape -= d.modes[k] * mode_means_[k];
    return shape * (1.0 + d.certificate) * (1.0 + d.integral);
  }

  [[nodiscard]] double scatter_of(const RawReading& reading) const {
    const auto m = static_cast<double>(reading.frames.size());
    if (told_.detector.noise != calibration::NoiseSource::RepeatedFrames || m < 2.0) return 0.0;
    double mean = 0.0, squares = 0.0;
    for (const RawFrame& frame : reading.frames) mean += frame.region.mean / m;
    for (const RawFrame& frame : reading.frames) squares += std::pow(frame.region.mean - mean, 2);
    return std::sqrt(squares / (m - 1.0));
  }

  void disturb_frame(RawFrame& frame, Target target, double light, const SharedDraw& d, double dark_drift,
                     double scatter, sim::Chance& chance) const {
    const sim::DetectorSpec& spec = scene_.detector;
    const double current = spec.dark_dn_per_s * frame.exposure_s;
    const double dark = spec.offset_dn + current;
    const double net = target == Target::Dark ? 0.0 : frame.region.mean - dark;
    const double variance =
        std::pow(told_.detector.read_noise_dn, 2) + (current + std::max(0.0, net)) / told_.detector.electrons_per_dn;
    const bool by_scatter = scatter > 0.0 && target != Target::Dark;
    const double noise = by_scatter ? scatter : std::sqrt(variance / frame.region.n);
    const double t = frame.exposure_s + told_.detector.exposure_offset_s.value;
    const double longer = 1.0 + d.offset_s / t;
    const double x = net / told_.detector.full_scale_dn;
    double straight = 1.0;  // by the true curve over the told one
    for (std::size_t k = 0; k < d.curve.size(); ++k) straight += d.curve[k] * std::pow(x, static_cast<double>(k + 1));
    const bool is_lit = target == Target::Sample || target == Target::Reference;
    const double beside = is_lit ? background_dn_per_s_ * frame.exposure_s : 0.0;  // whatever the target does
    const double bent = ((net - beside) * light + beside) * longer / straight;
    frame.region.mean = (target == Target::Dark ? frame.region.mean : dark) +
                        bent * (1.0 + d.linearity * bent / told_.detector.full_scale_dn) + noise * chance.normal();
    if (target != Target::Dark) frame.region.mean += dark_drift * frame.exposure_s;
  }

  void disturb_power(RawFrame& frame, Target target, double light, const SharedDraw& d,
                     const std::vector<double>& zeros, sim::Chance& chance) const {
    const MeterSpec& meter = plan_.meter;
    calibration::PowerReading& power = *frame.power;
    const auto range = static_cast<std::size_t>(
        std::ranges::min_element(meter.ranges_w, {}, [&](double r) { return std::abs(std::log(r / power.range_w)); }) -
        meter.ranges_w.begin());
    const double noise = meter.noise * power.range_w / std::sqrt(static_cast<double>(power.samples));
    if (target != Target::Dark) {
      const double w = power.mean_w * light;
      power.mean_w = w * (1.0 + d.linearity * w / power.range_w) * d.range_gains[range] + zeros[range] * power.range_w;
    }
    power.mean_w += noise * chance.normal();
  }

  const sim::Scene& scene_;
  const ScanPlan& plan_;
  const calibration::InstrumentModel& told_;
  const sim::Truth& truth_;
  const ScanReadings& measured_;
  double background_dn_per_s_;
  std::vector<double> mode_means_;
};

/// Sums over draws of each point's departure from the undisturbed value.
struct Departures {
  std::vector<double> sum, squares;
  explicit Departures(std::size_t points) : sum(points, 0.0), squares(points, 0.0) {}
};

// What the budget states of components that no input carries, as one draw of each.
std::vector<double> stated_departures(const CalibratedScan& nominal, sim::Chance& chance) {
  std::vector<double> component_draw(nominal.components.size());
  for (double& z : component_draw) z = chance.normal();
  std::vector<double> departures;
  for (const auto& point : nominal.points) {
    double sum = 0.0;
    for (const auto& term : point.budget.shared) {
      if (!is_carried_by_inputs(nominal.components[term.component].name))
        sum += term.per_sd.si() * component_draw[term.component];
    }
    for (const auto& term : point.budget.random) {
      if (!is_carried_by_inputs(nominal.components[term.component].name)) sum += term.per_sd.si() * chance.normal();
    }
    departures.push_back(sum);
  }
  return departures;
}

/// Fixed blocks of draws, so that the sums are the same on any number of threads.
constexpr int kBlocks = 16;

Result<Departures> run_block(const PreparedScene& prepared, const calibration::ReferenceStandard& standard,
                             const Disturber& disturber, const CalibratedScan& nominal, int draws, std::uint64_t seed) {
  Departures d(nominal.points.size());
  calibration::CalibrationOptions how;
  how.threads = 1;
  how.monte_carlo = calibration::MonteCarloUse::Never;  // of the values alone is asked here
  for (int k = 0; k < draws; ++k) {
    const std::uint64_t key = seed + static_cast<std::uint64_t>(k);
    const auto scan = calibration::calibrate(disturber.draw(key), prepared.told, standard, kDayOfBudget, how);
    if (!scan) return failure(scan.error());
    sim::Chance chance(key, static_cast<sim::Purpose>(1002));
    const std::vector<double> stated = stated_departures(nominal, chance);
    for (const auto& point : scan->points) {
      const auto same =
          std::ranges::find(nominal.points, point.point_index, &calibration::CalibratedPoint::point_index);
      if (same == nominal.points.end()) continue;
      const auto n = static_cast<std::size_t>(same - nominal.points.begin());
      const double departure = point.value.si() - same->value.si() + stated[n];
      d.sum[n] += departure;
      d.squares[n] += departure * departure;
    }
  }
  return d;
}

BudgetComparison summary(const CalibratedScan& nominal, const Departures& all, int draws) {
  BudgetComparison c{.draws = draws, .least_point = INFINITY, .as_stated = {}};
  const double n = draws;
  for (std::size_t p = 0; p < nominal.points.size(); ++p) {
    const double mean = all.sum[p] / n;
    const double ratio = std::sqrt(all.squares[p] / n - mean * mean) / nominal.points[p].budget.u.si();
    c.ratio += ratio * ratio / static_cast<double>(nominal.points.size());
    c.least_point = std::min(c.least_point, ratio);
    c.largest_point = std::max(c.largest_point, ratio);
  }
  c.ratio = std::sqrt(c.ratio);
  c.standard_error = 1.0 / std::sqrt(2.0 * n);
  for (const auto& component : nominal.components) {
    if (!is_carried_by_inputs(component.name)) c.as_stated.push_back(component.name);
  }
  return c;
}

}  // namespace

Result<BudgetComparison> compare_budget(const PreparedScene& prepared, int draws, std::uint64_t seed, int threads) {
  sim::Scene quiet = prepared.base;
  quiet.draws_errors = false;
  quiet.seed = seed;
  quiet.angles.u_repeat = {};
  quiet.lamp.u_reproducibility = quiet.lamp.u_after_monitor = 0.0;
  quiet.effects.exposure_offset_s = prepared.told.detector.exposure_offset_s.value;
  const sim::ReadingLevel instrument(quiet);
  ScanPlan plan = prepared.scene.plan;
  plan.u_dark_drift_dn_per_s = plan.step = 0.0;
  plan.meter.u_range = plan.meter.u_zero = plan.meter.u_linearity = 0.0;
  ShortScan short_scan(plan, prepared.points);
  const ScanReadings measured = short_scan.measure(instrument);
  const calibration::ReferenceStandard standard(prepared.reference);
  calibration::CalibrationOptions by_formula;
  by_formula.monte_carlo = calibration::MonteCarloUse::Never;
  const auto nominal = calibration::calibrate(measured, prepared.told, standard, kDayOfBudget, by_formula);
  if (!nominal) return failure(nominal.error());
  const Disturber disturber(prepared, instrument.truth(), measured);

  std::vector<std::optional<Result<Departures>>> blocks(kBlocks);
  const int each = std::max(1, draws / kBlocks);
  const auto work = [&](int first) {
    for (int b = first; b < kBlocks; b += threads) {
      blocks[static_cast<std::size_t>(b)].emplace(
          run_block(prepared, standard, disturber, *nominal, each, seed + static_cast<std::uint64_t>(b * each)));
    }
  };
  std::vector<std::jthread> helpers;
  for (int t = 1; t < threads; ++t) helpers.emplace_back(work, t);
  work(0);
  helpers.clear();  // joins
  Departures all(nominal->points.size());
  for (const auto& block : blocks) {
    if (!*block) return failure(block->error());
    for (std::size_t p = 0; p < all.sum.size(); ++p) {
      all.sum[p] += (*block)->sum[p];
      all.squares[p] += (*block)->squares[p];
    }
  }
  return summary(*nominal, all, each * kBlocks);
}

}  // namespace gonio::coverage
