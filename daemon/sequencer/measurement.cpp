#include "daemon/sequencer/measurement.h"

#include <algorithm>
#include <set>
#include <utility>

namespace gonio::daemon {

namespace {

// A probe is worth its time when the better rung at least halves what is left to do. Each change costs a frame:
// bounded.
constexpr int kMostChanges = 4;

}  // namespace

Measurement Measurement::of_item(const ExposureChooser& chooser, calibration::Target target, int filter) {
  Measurement item;
  item.target_ = target;
  item.filter_ = filter;
  item.stated_ = chooser.stated();
  item.rung_ = item.stated_.empty() ? chooser.first_plan(target, filter).rung : item.stated_.front();
  item.ceiling_ = chooser.rungs().size() - 1;
  return item;
}

Measurement Measurement::of_dark(std::size_t lowest, std::size_t highest, int frames) {
  Measurement dark;
  dark.is_dark_ = true;
  dark.rung_ = lowest;
  dark.ceiling_ = highest;
  dark.dark_frames_ = frames;
  return dark;
}

Measurement::Verdict Measurement::add(ReadingRecord reading, ExposureChooser& chooser) {
  const calibration::RegionMoments region = reading.region;
  readings_.push_back(std::move(reading));
  rung_of_reading_.push_back(rung_);
  if (is_dark_) return add_dark(region.mean, chooser);
  if (!stated_.empty()) return add_stated(region, chooser);
  if (region.saturated > 0) return add_saturated();
  ++on_rung_;
  sum_dn_ += region.mean;
  return add_lit(region.n, chooser);
}

Measurement::Verdict Measurement::add_dark(double mean_dn, ExposureChooser& chooser) {
  ++on_rung_;
  sum_dn_ += mean_dn;
  if (on_rung_ < dark_frames_) return Verdict::More;
  chooser.learn_dark(rung_, this->mean_dn());
  if (rung_ >= ceiling_) return Verdict::Done;
  ++rung_;
  on_rung_ = 0;
  sum_dn_ = 0.0;
  return Verdict::More;
}

// A saturated frame says only "less": two rungs down at once, and never up to this one again.
Measurement::Verdict Measurement::add_saturated() {
  readings_.back().used = false;
  if (rung_ == 0) return Verdict::Saturated;
  ceiling_ = rung_ - 1;
  change_rung(rung_ >= 2 ? rung_ - 2 : 0);
  return Verdict::More;
}

Measurement::Verdict Measurement::add_lit(std::uint32_t pixels, ExposureChooser& chooser) {
  const double net_dn = mean_dn() - chooser.dark_dn(rung_);
  const ExposureChooser::Signal signal{net_dn / chooser.weight(rung_), pixels};
  const int needed = chooser.frames_needed(rung_, signal);
  if (on_rung_ == 1 && needed > 1 && changes_ < kMostChanges) {
    const ExposurePlan best = chooser.choose(signal, ceiling_);
    const bool is_cheaper = 2 * chooser.cost(best) < chooser.cost({rung_, needed - 1});
    const bool reaches_more = chooser.reaches(best.rung, signal) && !chooser.reaches(rung_, signal);
    const bool sees_more = !chooser.reaches(rung_, signal) && best.rung > rung_;
    if (best.rung != rung_ && (is_cheaper || reaches_more || sees_more)) {
      change_rung(best.rung);
      return Verdict::More;
    }
  }
  if (on_rung_ < needed) return Verdict::More;
  chooser.remember(target_, filter_, signal);
  return Verdict::Done;
}

Measurement::Verdict Measurement::add_stated(const calibration::RegionMoments& region, ExposureChooser& chooser) {
  if (region.saturated > 0) return drop_stated_rung(chooser);
  ++on_rung_;
  sum_dn_ += region.mean;
  tried_ = std::max<std::size_t>(tried_, 1);
  if (rung_ == stated_[tried_ - 1] && tried_ < stated_.size()) {
    return_to(stated_[tried_++]);
    return Verdict::More;
  }
  return comes_down() ? Verdict::Done : repeat_longest(region.n, chooser);
}

// A rung counts whole or not at all: to keep just those frames that noise left below full scale would bias the mean.
Measurement::Verdict Measurement::drop_stated_rung(ExposureChooser& chooser) {
  for (std::size_t k = 0; k < readings_.size(); ++k) {
    if (rung_of_reading_[k] == rung_) readings_[k].used = false;
  }
  const auto tried_end = stated_.begin() + static_cast<std::ptrdiff_t>(tried_);
  tried_ = static_cast<std::size_t>(std::count_if(stated_.begin(), tried_end, [this](auto r) { return r < rung_; }));
  std::erase_if(stated_, [this](std::size_t rung) { return rung >= rung_; });
  if (stated_.empty()) return Verdict::Saturated;
  if (tried_ < stated_.size()) {
    return_to(stated_[tried_++]);
    return Verdict::More;
  }
  return_to(stated_.back());
  if (comes_down()) return Verdict::Done;
  return repeat_longest(readings_.back().region.n, chooser);
}

Measurement::Verdict Measurement::repeat_longest(std::uint32_t pixels, ExposureChooser& chooser) {
  const ExposureChooser::Signal signal{(mean_dn() - chooser.dark_dn(rung_)) / chooser.weight(rung_), pixels};
  Duration spent{};
  for (const std::size_t rung : rung_of_reading_) spent += chooser.rungs()[rung];
  const bool is_in_time = spent + chooser.rungs()[rung_] <= chooser.max_time();
  if (is_in_time && on_rung_ < chooser.frames_needed(rung_, signal)) return Verdict::More;
  return Verdict::Done;
}

std::optional<ExposureChooser::Signal> Measurement::expected_signal(const ExposureChooser& chooser) const {
  if (on_rung_ == 0) return chooser.last_signal(target_, filter_);
  const std::uint32_t pixels = readings_.back().region.n;
  return ExposureChooser::Signal{(mean_dn() - chooser.dark_dn(rung_)) / chooser.weight(rung_), pixels};
}

bool Measurement::expects_no_more(const ExposureChooser& chooser) const {
  if (is_dark_) return false;
  const bool is_on_last = stated_.empty() || (rung_ == stated_.back() && tried_ + 1 >= stated_.size());
  const auto signal = expected_signal(chooser);
  if (!is_on_last || !signal) return false;
  // Of frames before it the scatter is known to be small; from one item to another the signal changes.
  const double change = on_rung_ == 0 ? chooser.usual_change() : 0.0;
  const ExposureChooser::Signal darker{signal->rate_dn_per_s * (1.0 - change), signal->pixels};
  const ExposureChooser::Signal brighter{signal->rate_dn_per_s * (1.0 + change), signal->pixels};
  return on_rung_ + 1 >= chooser.frames_needed(rung_, darker) && chooser.is_clear_of_full_scale(rung_, brighter);
}

std::vector<std::size_t> Measurement::used_rungs() const {
  std::set<std::size_t> rungs;
  for (std::size_t k = 0; k < readings_.size(); ++k) {
    if (readings_[k].used) rungs.insert(rung_of_reading_[k]);
  }
  return {rungs.begin(), rungs.end()};
}

std::int64_t Measurement::used_frames_of(std::size_t rung) const {
  std::int64_t frames = 0;
  for (std::size_t k = 0; k < readings_.size(); ++k) {
    if (readings_[k].used && rung_of_reading_[k] == rung) ++frames;
  }
  return frames;
}

// Its frames so far count on.
void Measurement::return_to(std::size_t rung) {
  rung_ = rung;
  on_rung_ = 0;
  sum_dn_ = 0.0;
  for (std::size_t k = 0; k < readings_.size(); ++k) {
    if (rung_of_reading_[k] != rung || !readings_[k].used) continue;
    ++on_rung_;
    sum_dn_ += readings_[k].region.mean;
  }
}

void Measurement::change_rung(std::size_t rung) {
  for (ReadingRecord& reading : readings_) reading.used = false;
  ++changes_;
  rung_ = rung;
  on_rung_ = 0;
  sum_dn_ = 0.0;
}

}  // namespace gonio::daemon
