#include "daemon/sequencer/measurement.h"

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
  item.rung_ = chooser.first_plan(target, filter).rung;
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
  if (is_dark_) return add_dark(region.mean, chooser);
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
  const ExposureChooser::Signal signal{net_dn / in_seconds(chooser.rungs()[rung_]), pixels};
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

void Measurement::change_rung(std::size_t rung) {
  for (ReadingRecord& reading : readings_) reading.used = false;
  ++changes_;
  rung_ = rung;
  on_rung_ = 0;
  sum_dn_ = 0.0;
}

}  // namespace gonio::daemon
