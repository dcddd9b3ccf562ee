#include "daemon/app/plan_outlook.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "daemon/planner/exposure_ladder.h"

namespace gonio::daemon {

namespace {

// Measured on stores of finished scans, their indices included: item, attempt, events, result, and one frame of 240
// bytes.
constexpr std::int64_t kBytesAnItem = 1250;
constexpr std::int64_t kBytesAVisit = 8000;  // some thirty frames
constexpr double kMotionKnown = 0.02;

double square(double x) {
  return x * x;
}

double relative_u(const ScanPoint& point, const api::Plan& plan, const Instrument& instrument,
                  const calibration::ReferenceStandard& standard) {
  constexpr double kCoverage = 2.0;
  const Geometry& g = point.geometry;
  const auto rho = standard.reflectance(point.wavelength);
  double variance = rho ? square(rho->u / rho->value) : 0.0;  // its reach has been checked
  variance += square(standard.u_integral()) + square(standard.u_interpolation(g) / standard.shape(g));
  for (std::size_t k = 0; k < standard.modes().size(); ++k) {
    variance += square(standard.mode(k, g) * standard.modes()[k].u);
  }
  const calibration::InstrumentModel& model = instrument.model;
  variance += 2.0 * (square(1.0 / plan.target_snr) + square(model.lamp.u_reproducibility));
  const double apart = in_seconds(plan.block) / model.lamp.correlation_s;
  variance += square(model.lamp.u_after_monitor) * (1.0 - std::exp(-0.5 * apart * apart));
  return kCoverage * std::sqrt(variance);
}

double u_exposures_s(const api::Plan& plan, const PlannedScan& planned, const Instrument& instrument) {
  const auto ladder = exposure_ladder(instrument.detector, plan.max_time);
  if (!plan.exposures.empty() || ladder.front() == ladder.back()) return 0.0;
  const double shortest = in_seconds(*std::ranges::min_element(ladder));
  const double longest = in_seconds(*std::ranges::max_element(ladder));
  const double span = std::log(longest / shortest);
  const double mean = (longest - shortest) / span;
  const double mean_square = (longest * longest - shortest * shortest) / (2.0 * span);
  return static_cast<double>(planned.items) * std::sqrt(std::max(0.0, mean_square - mean * mean));
}

std::int64_t times(Duration total, Duration every) {
  constexpr std::int64_t kFirstAndLast = 2;
  return every > Duration::zero() ? kFirstAndLast + total / every : 0;
}

}  // namespace

PlanOutlook outlook(const api::Plan& plan, const PlannedScan& planned, const Instrument& instrument,
                    const calibration::ReferenceStandard& standard) {
  PlanOutlook outlook;
  std::vector<double> all;
  for (const std::int32_t index : planned.order) {
    all.push_back(relative_u(planned.points[static_cast<std::size_t>(index)], plan, instrument, standard));
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::ranges::nth_element(all, middle);
  outlook.median_relative_u = *middle;
  outlook.worst_relative_u = *std::ranges::max_element(all);
  const Duration total = planned.estimate.total();
  outlook.u_estimate_s = std::hypot(u_exposures_s(plan, planned, instrument),
                                    kMotionKnown * in_seconds(planned.estimate.move + planned.estimate.settle));
  outlook.visits = times(total, plan.dark_every) + times(total, plan.reference_every) + times(total, plan.check_every);
  outlook.disk_bytes = kBytesAnItem * planned.items + kBytesAVisit * outlook.visits;
  return outlook;
}

}  // namespace gonio::daemon
