#include "daemon/planner/light_forecast.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "daemon/planner/visit_place.h"

namespace gonio::daemon {

namespace {

using calibration::Target;

constexpr double kSameLine_nm = 0.5;

ReadingLimits limits_of(const api::Plan& plan) {
  return {plan.target_snr, plan.max_time, plan.exposures};
}

double geometric_mean_s(const std::vector<Duration>& ladder) {
  return std::sqrt(in_seconds(ladder.front()) * in_seconds(ladder.back()));
}

}  // namespace

LightForecast::LightForecast(const api::Plan& plan, const Instrument& instrument, const TimeExperience& experience)
    : white_(experience.white),
      expected_(plan.expected_reflectance),
      target_snr_(plan.target_snr),
      is_guess_(plan.exposures.empty() && !instrument.detector.power),
      pixels_(static_cast<std::uint32_t>(
          std::max(1.0, std::numbers::pi * std::pow(instrument.detector.aperture.radius_px, 2)))),
      chooser_(instrument, limits_of(plan)),
      visit_chooser_(chooser_.for_visit(visit_snr(plan.drift_limit), std::nullopt)) {
  unknown_.exposure = seconds(geometric_mean_s(chooser_.rungs()));
  if (plan.exposures.empty()) return;
  unknown_.exposure = std::accumulate(plan.exposures.begin(), plan.exposures.end(), Duration{});
  unknown_.frames = static_cast<int>(plan.exposures.size());
}

double LightForecast::reflectance_of(Target target) const {
  return target == Target::Sample ? expected_.value_or(0.0) : 1.0;
}

// The detector sees a part of the spot only, so its signal goes with the light on it.
std::optional<ExposureChooser::Signal> LightForecast::signal_of(const ScanPoint& point, double reflectance) const {
  if (!expected_) return std::nullopt;
  const auto seen = std::ranges::find_if(white_, [&point](const WhiteSignal& white) {
    return std::abs(in_nanometres(white.wavelength) - in_nanometres(point.wavelength)) < kSameLine_nm;
  });
  if (seen == white_.end()) return std::nullopt;
  return ExposureChooser::Signal{seen->dn_per_s * reflectance * std::cos(point.geometry.theta_i.si()), pixels_};
}

LightForecast::Light LightForecast::by(const ExposureChooser& chooser, const ScanPoint& point, Target target) const {
  const auto signal = is_guess_ ? signal_of(point, reflectance_of(target)) : std::nullopt;
  if (!signal) return unknown_;
  const ExposurePlan plan = chooser.choose(*signal, chooser.rungs().size() - 1);
  return {.exposure = plan.frames * chooser.rungs()[plan.rung],
          .frames = plan.frames,
          .lowest = plan.rung,
          .highest = plan.rung};
}

LightForecast::Light LightForecast::of(const ScanPoint& point, Target target) const {
  return by(chooser_, point, target);
}

LightForecast::Light LightForecast::of_visit(const ScanPoint& point, Target target) const {
  return by(visit_chooser_, point, target);
}

double LightForecast::relative_noise(const ScanPoint& point, Target target) const {
  const auto signal = is_guess_ ? signal_of(point, reflectance_of(target)) : std::nullopt;
  if (!signal || signal->rate_dn_per_s <= 0.0) return 1.0 / target_snr_;
  const ExposurePlan plan = chooser_.choose(*signal, chooser_.rungs().size() - 1);
  const double net = signal->rate_dn_per_s * chooser_.weight(plan.rung);
  return std::sqrt(chooser_.frame_variance(net, signal->pixels) / plan.frames) / net;
}

double LightForecast::u_guess_s() const {
  const double shortest = in_seconds(*std::ranges::min_element(rungs()));
  const double longest = in_seconds(*std::ranges::max_element(rungs()));
  if (!is_guess_ || shortest == longest) return 0.0;
  const double span = std::log(longest / shortest);
  const double mean = (longest - shortest) / span;
  const double mean_square = (longest * longest - shortest * shortest) / (2.0 * span);
  return std::sqrt(std::max(0.0, mean_square - mean * mean));
}

}  // namespace gonio::daemon
