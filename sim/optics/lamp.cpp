#include "sim/optics/lamp.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "sim/scene/chance.h"

namespace gonio::sim {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Cells before the scene's beginning have counters too.
std::uint64_t counter_of(double cell) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(cell));
}

}  // namespace

Lamp::Lamp(const Scene& scene)
    : seed_(scene.seed),
      spec_(scene.lamp),
      wave_phase_(kTurn * Chance(scene.seed, Purpose::LampPhase).uniform()),
      drift_(scene.seed, Purpose::MonitorDrift, scene.lamp.correlation_s) {}

double Lamp::slow_mean(double from_s, double to_s) const {
  double relative = 1.0 + spec_.drift_per_hour * 0.5 * (from_s + to_s) / 3600.0;
  if (spec_.wave != 0.0) {
    const double omega = kTurn / spec_.wave_period_s;
    // The mean of sin over the stretch, as sin at its middle times sinc: no difference of near equals.
    const double half = 0.5 * omega * (to_s - from_s);
    const double sinc = half == 0.0 ? 1.0 : std::sin(half) / half;
    relative += spec_.wave * sinc * std::sin(omega * 0.5 * (from_s + to_s) + wave_phase_);
  }
  return spec_.power * relative;
}

double Lamp::flicker_mean(double from_s, double to_s) const {
  if (spec_.flicker == 0.0) return 0.0;
  const double cell = spec_.flicker_cell_s;
  double sum = 0.0;
  for (double k = std::floor(from_s / cell); k * cell < to_s; k += 1.0) {
    const double overlap = std::min(to_s, (k + 1.0) * cell) - std::max(from_s, k * cell);
    if (overlap > 0.0) sum += overlap * Chance(seed_, Purpose::Flicker, counter_of(k)).normal();
  }
  return spec_.flicker * sum / (to_s - from_s);
}

double Lamp::mean(double from_s, double to_s) const {
  assert(to_s > from_s);
  return slow_mean(from_s, to_s) * (1.0 + flicker_mean(from_s, to_s));
}

double Lamp::monitor_drift(double at_s) const {
  if (spec_.u_after_monitor == 0.0) return 0.0;
  // The stated uncertainty is that of a difference of two readings: each has it / sqrt(2).
  return drift_.at(at_s, spec_.u_after_monitor / std::numbers::sqrt2);
}

double Lamp::monitored(double from_s, double to_s) const {
  return mean(from_s, to_s) * (1.0 + monitor_drift(0.5 * (from_s + to_s)));
}

MonitorReading Lamp::monitor(double from_s, double to_s, std::uint64_t exposure) const {
  constexpr double kFewest = 4.0;
  constexpr double kMost = 1e6;
  const double n = std::clamp(std::floor((to_s - from_s) * spec_.monitor_rate_hz), kFewest, kMost);
  const double mean_true = monitored(from_s, to_s);
  MonitorReading reading{.mean = mean_true, .standard_error = 0.0, .samples = static_cast<std::uint32_t>(n)};
  if (spec_.monitor_noise == 0.0) return reading;
  // Mean and variance of n normal samples are independent: drawn directly instead of sample by sample.
  Chance chance(seed_, Purpose::MonitorNoise, exposure);
  const double sigma = spec_.monitor_noise * mean_true;
  reading.mean += sigma / std::sqrt(n) * chance.normal();
  reading.standard_error = sigma * std::sqrt(chance.chi_squared(n - 1.0) / (n - 1.0) / n);
  return reading;
}

double Lamp::monitor_now(double at_s) const {
  const double sample_s = 1.0 / spec_.monitor_rate_hz;
  const double noise =
      spec_.monitor_noise == 0.0
          ? 0.0
          : spec_.monitor_noise * Chance(seed_, Purpose::MonitorNow, counter_of(std::floor(at_s / sample_s))).normal();
  return mean(at_s, at_s + sample_s) * (1.0 + monitor_drift(at_s)) * (1.0 + noise);
}

}  // namespace gonio::sim
