#include "daemon/desks/plan_outlook.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "daemon/planner/light_forecast.h"

namespace gonio::daemon {

namespace {

using calibration::Target;

// Measured on stores of finished scans, their indices included: item, attempt, events, result, and one frame of 240
// bytes.
constexpr std::int64_t kBytesAnItem = 1250;
constexpr std::int64_t kBytesAVisit = 8000;  // some thirty frames

double square(double x) {
  return x * x;
}

double relative_u(const ScanPoint& point, const api::Plan& plan, const Instrument& instrument,
                  const calibration::ReferenceStandard& standard, const LightForecast& light) {
  constexpr double kCoverage = 2.0;
  const Geometry& g = point.geometry;
  const auto rho = standard.reflectance(point.wavelength);
  double variance = rho ? square(rho->u / rho->value) : 0.0;  // its reach has been checked
  variance += square(standard.u_integral()) +
              square(standard.u_interpolation(g, point.wavelength) / standard.shape(g, point.wavelength));
  for (std::size_t k = 0; k < standard.modes().size(); ++k) {
    variance += square(standard.mode(k, g, point.wavelength) * standard.modes()[k].u);
  }
  const calibration::InstrumentModel& model = instrument.model;
  variance +=
      square(light.relative_noise(point, Target::Sample)) + square(light.relative_noise(point, Target::Reference));
  variance += 2.0 * square(model.lamp.u_reproducibility);
  const double apart = in_seconds(plan.block) / model.lamp.correlation_s;
  variance += square(model.lamp.u_after_monitor) * (1.0 - std::exp(-0.5 * apart * apart));
  return kCoverage * std::sqrt(variance);
}

std::int64_t times(Duration total, Duration every) {
  constexpr std::int64_t kFirstAndLast = 2;
  return every > Duration::zero() ? kFirstAndLast + total / every : 0;
}

}  // namespace

PlanOutlook outlook(const api::Plan& plan, const PlannedScan& planned, const Instrument& instrument,
                    const calibration::ReferenceStandard& standard) {
  PlanOutlook outlook;
  api::Plan chosen = plan;
  if (planned.budget) chosen.target_snr = planned.budget->target_snr;
  const LightForecast light(chosen, instrument, planned.experience);
  for (const std::int32_t index : planned.order) {
    const ScanPoint& point = planned.points[static_cast<std::size_t>(index)];
    outlook.relative_u.push_back(relative_u(point, chosen, instrument, standard, light));
  }
  std::vector<double> all = outlook.relative_u;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::ranges::nth_element(all, middle);
  outlook.median_relative_u = *middle;
  outlook.worst_relative_u = *std::ranges::max_element(all);
  const Duration total = planned.estimate.total();
  outlook.visits = times(total, plan.dark_every) + times(total, plan.reference_every) + times(total, plan.check_every);
  outlook.disk_bytes = kBytesAnItem * planned.items + kBytesAVisit * outlook.visits;
  return outlook;
}

}  // namespace gonio::daemon
