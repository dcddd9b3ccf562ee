#include "daemon/sequencer/time_estimate.h"

#include <algorithm>
#include <cmath>

namespace gonio::daemon {

namespace {

// Standard deviation of a count that is rounded to whole ones (JCGM 100:2008, 4.3.7: 1 / sqrt(12)).
constexpr double kRounding = 0.289;
constexpr double kCommitGain = 0.02;   // of an exponential mean: fifty items
constexpr double kCommitDoubt = 0.5;   // of that mean: the next hour need not be like the last minute, relative
constexpr double kRatioError = 0.003;  // of moves to come beside those measured, relative

Duration working(const TimeParts& took) {
  return took.expose + took.read + took.idle.wire + took.idle.planning;
}

// The first one probes; it counts only while it is alone.
void add_after_first(DurationStatistics& statistics, Duration d, bool first_is_in) {
  if (first_is_in) statistics = {};
  statistics.add(d);
}

Remaining operator+(const Remaining& a, const Remaining& b) {
  return {a.time_s + b.time_s, a.variance_s2 + b.variance_s2};
}

double squared(double x) {
  return x * x;
}

}  // namespace

void DurationStatistics::add(Duration d) {
  ++n_;
  const double from_mean = in_seconds(d) - mean_s_;
  mean_s_ += from_mean / static_cast<double>(n_);
  m2_s2_ += from_mean * (in_seconds(d) - mean_s_);
}

Remaining remaining(const DurationStatistics& measured, std::int64_t left) {
  if (measured.count() == 0 || left <= 0) return {};
  const auto n = static_cast<double>(left);
  const auto m = static_cast<double>(measured.count());
  return {.time_s = n * measured.mean_s(), .variance_s2 = measured.variance_s2() * (n + n * n / m)};
}

TimeParts& operator+=(TimeParts& sum, const TimeParts& more) {
  sum.move += more.move;
  sum.settle += more.settle;
  sum.expose += more.expose;
  sum.read += more.read;
  sum.idle.commit += more.idle.commit;
  sum.idle.wire += more.idle.wire;
  sum.idle.device += more.idle.device;
  sum.idle.hold += more.idle.hold;
  sum.idle.planning += more.idle.planning;
  return sum;
}

void EndEstimate::add_item(calibration::Target target, const TimeParts& took, const StepTime& model, bool is_turn) {
  const bool is_sample = target == calibration::Target::Sample;
  DurationStatistics& work = is_sample ? sample_ : reference_;
  bool& has_first = is_sample ? only_first_sample_ : only_first_reference_;
  const bool drops_first = has_first;
  has_first = work.count() == 0 && !drops_first;
  add_after_first(work, working(took), drops_first);
  commit_s_ += kCommitGain * (in_seconds(took.idle.commit) - commit_s_);
  if (is_turn) return;
  took_s_ += in_seconds(took.move + took.settle);
  by_model_s_ += in_seconds(model.move + model.settle);
}

void EndEstimate::expect_motion(double ratio) {
  constexpr double kWorth_s = 60.0;
  took_s_ += kWorth_s * ratio;
  by_model_s_ += kWorth_s;
}

void EndEstimate::add_dark(const TimeParts& took) {
  dark_beyond_light_.add(took.move + took.settle + took.read + took.idle.wire + took.idle.commit);
}

Remaining EndEstimate::of(const WorkLeft& left) const {
  const Remaining items = work_of(left) + way_of(left);
  Remaining all = items + darks_of(left, items.time_s);
  all.time_s += in_seconds(left.other_visits);
  return all;
}

// Until one of the targets was measured, the other stands for it.
Remaining EndEstimate::work_of(const WorkLeft& left) const {
  const DurationStatistics& sample = sample_.count() > 0 ? sample_ : reference_;
  const DurationStatistics& reference = reference_.count() > 0 ? reference_ : sample_;
  const double waits_s = commit_s_ * static_cast<double>(left.samples + left.references);
  return remaining(sample, left.samples) + remaining(reference, left.references) +
         Remaining{waits_s, squared(kCommitDoubt * waits_s)};
}

Remaining EndEstimate::way_of(const WorkLeft& left) const {
  const double time_s = ratio() * (left.way_s + left.turns_s);
  return {time_s, squared(kRatioError * time_s) + squared(left.u_way_s) + squared(left.u_turns_s)};
}

Remaining EndEstimate::darks_of(const WorkLeft& left, double items_s) const {
  const double every_s = in_seconds(left.dark_every);
  const double darks = 1.0 + (every_s > 0.0 ? std::floor(items_s / every_s) : 0.0);
  const double one_s = in_seconds(left.dark_light) + dark_beyond_light_.mean_s();
  return {darks * one_s, squared(kRounding * one_s)};
}

}  // namespace gonio::daemon
