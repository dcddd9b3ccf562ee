#include "daemon/planner/exposure_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "daemon/planner/exposure_ladder.h"

namespace gonio::daemon {

namespace {

// The mean in the aperture stays below this share of full scale: the brightest pixel and the next geometry lie above
// it.
constexpr double kFill = 0.5;
constexpr double kSureFill = 0.7;  // whatever the pixels' unevenness about their mean
constexpr double kChangeAtFirst = 0.1;
constexpr double kChangeGain = 0.1;  // of an exponential mean
constexpr Duration kFrameTimeAtFirst = std::chrono::milliseconds(5);
constexpr double kFrameTimeGain = 0.1;  // of an exponential mean: ten frames or so

}  // namespace

ExposureChooser::ExposureChooser(const Instrument& instrument, const ReadingLimits& limits)
    : mean_change_(kChangeAtFirst),
      target_snr_(limits.target_snr),
      max_time_(limits.max_time),
      frames_at_most_(instrument.detector.frames_at_most),
      electrons_per_dn_(instrument.model.detector.electrons_per_dn /
                        std::pow(10.0, instrument.detector.gain_db / 20.0)),
      read_noise_dn_(instrument.model.detector.read_noise_dn),
      full_scale_dn_(instrument.model.detector.full_scale_dn),
      frame_time_(kFrameTimeAtFirst) {
  rungs_ = exposure_ladder(instrument.detector, limits.max_time);
  // The planner has checked them; a scan resumes under the same configuration only.
  if (auto stated = rungs_of(limits.exposures, rungs_)) stated_ = std::move(*stated);
  dark_dn_.assign(rungs_.size(), 0.0);
  top_ = rungs_.size() - 1;
  if (instrument.detector.power) ranges_w_ = instrument.detector.power->ranges_w;
  for (const Duration rung : rungs_) weights_.push_back(in_seconds(rung));
  std::ranges::transform(ranges_w_, weights_.begin(), [](double range_w) { return 1.0 / range_w; });
  if (ranges_w_.empty()) return;
  const PowerDetectorConfig& power = *instrument.detector.power;
  const double samples = static_cast<double>(power.samples) * static_cast<double>(power.meter.averages);
  electrons_per_dn_ = std::numeric_limits<double>::infinity();  // its noise is that of the range
  read_noise_dn_ = instrument.model.detector.power.value_or(calibration::PowerModel{}).noise / std::sqrt(samples);
}

std::optional<double> ExposureChooser::range_w(std::size_t rung) const {
  return ranges_w_.empty() ? std::nullopt : std::optional(ranges_w_[rung]);
}

double ExposureChooser::frame_variance(double net_dn, std::uint32_t pixels) const {
  return (std::max(net_dn, 0.0) / electrons_per_dn_ + 2.0 * read_noise_dn_ * read_noise_dn_) / pixels;
}

ExposureChooser ExposureChooser::for_visit(double target_snr, std::optional<std::size_t> rung) const {
  ExposureChooser chooser = *this;
  chooser.target_snr_ = std::max(target_snr_, target_snr);
  if (rung && stated_.empty()) chooser.stated_ = {*rung};
  return chooser;
}

double ExposureChooser::frames_wished(std::size_t rung, const Signal& signal) const {
  const double net = signal.rate_dn_per_s * weights_[rung];
  const double variance = frame_variance(net, signal.pixels);
  if (net <= std::sqrt(variance)) return std::numeric_limits<double>::infinity();  // nothing but noise
  return std::ceil(target_snr_ * target_snr_ * variance / (net * net));
}

int ExposureChooser::frames_allowed(std::size_t rung) const {
  const auto by_time = max_time_ / rungs_[rung];
  return static_cast<int>(std::clamp<std::int64_t>(by_time, 1, frames_at_most_));
}

int ExposureChooser::frames_needed(std::size_t rung, const Signal& signal) const {
  const double wished = frames_wished(rung, signal);
  return static_cast<int>(std::clamp(wished, 1.0, static_cast<double>(frames_allowed(rung))));
}

bool ExposureChooser::reaches(std::size_t rung, const Signal& signal) const {
  return frames_wished(rung, signal) <= frames_allowed(rung);
}

Duration ExposureChooser::cost(const ExposurePlan& plan) const {
  return plan.frames * (rungs_[plan.rung] + frame_time_);
}

ExposurePlan ExposureChooser::choose(const Signal& signal, std::size_t ceiling) const {
  std::optional<ExposurePlan> cheapest;
  ExposurePlan nearest;
  double nearest_lack = std::numeric_limits<double>::infinity();
  for (std::size_t rung = 0; rung <= std::min(ceiling, top_); ++rung) {
    const double level = dark_dn_[rung] + signal.rate_dn_per_s * weights_[rung];
    if (rung > 0 && level > kFill * full_scale_dn_) break;
    const ExposurePlan plan{rung, frames_needed(rung, signal)};
    // Of a radiometer's ranges all cost the same: the smallest has the least noise.
    const bool is_better =
        !cheapest || cost(plan) < cost(*cheapest) || (range_w(rung) && cost(plan) == cost(*cheapest));
    if (reaches(rung, signal) && is_better) cheapest = plan;
    const double lack = frames_wished(rung, signal) / plan.frames;
    if (lack < nearest_lack || std::isinf(lack)) {  // pure noise: the longest exposure sees the most
      nearest_lack = lack;
      nearest = plan;
    }
  }
  return cheapest.value_or(nearest);
}

ExposurePlan ExposureChooser::first_plan(calibration::Target target, int filter) const {
  const auto known = last_.find({target, filter});
  if (known == last_.end()) return {.rung = (top_ + 1) / 2, .frames = 1};
  return choose(known->second, rungs_.size() - 1);
}

bool ExposureChooser::change_limits(const DetectorConfig& detector, double target_snr, Duration max_time) {
  target_snr_ = target_snr;
  max_time_ = max_time;
  const std::vector<Duration> ladder = exposure_ladder(detector, max_time);
  top_ = ladder.size() - 1;
  if (ladder.size() <= rungs_.size()) return false;
  for (std::size_t rung = rungs_.size(); rung < ladder.size(); ++rung) {
    rungs_.push_back(ladder[rung]);
    weights_.push_back(in_seconds(ladder[rung]));
    dark_dn_.push_back(0.0);
  }
  return true;
}

void ExposureChooser::remember(calibration::Target target, int filter, const Signal& signal) {
  const auto before = last_signal(target, filter);
  last_[{target, filter}] = signal;
  if (!before || before->rate_dn_per_s <= 0.0 || signal.rate_dn_per_s <= 0.0) return;
  const double change = std::abs(std::log(signal.rate_dn_per_s / before->rate_dn_per_s));
  mean_change_ += kChangeGain * (change - mean_change_);
}

std::optional<ExposureChooser::Signal> ExposureChooser::last_signal(calibration::Target target, int filter) const {
  const auto known = last_.find({target, filter});
  return known == last_.end() ? std::nullopt : std::optional(known->second);
}

double ExposureChooser::usual_change() const {
  return std::min(2.0 * mean_change_, 0.9);
}

bool ExposureChooser::is_clear_of_full_scale(std::size_t rung, const Signal& signal) const {
  return dark_dn_[rung] + signal.rate_dn_per_s * weights_[rung] < kSureFill * full_scale_dn_;
}

void ExposureChooser::learn_frame_time(Duration beyond_exposure) {
  frame_time_ += Duration(
      static_cast<std::int64_t>(kFrameTimeGain * static_cast<double>((beyond_exposure - frame_time_).count())));
}

}  // namespace gonio::daemon
