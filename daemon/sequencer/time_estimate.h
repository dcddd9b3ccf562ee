#pragma once

#include <cstdint>

#include "base/clock.h"
#include "calibration/raw_reading.h"
#include "daemon/planner/estimate.h"
#include "daemon/planner/planned_scan.h"

namespace gonio::daemon {

/// Mean and scatter of durations (Welford 1962).
class DurationStatistics {
 public:
  void add(Duration d);
  [[nodiscard]] std::int64_t count() const { return n_; }
  [[nodiscard]] double mean_s() const { return mean_s_; }
  /// Of one; 0 below two values.
  [[nodiscard]] double variance_s2() const { return n_ > 1 ? m2_s2_ / static_cast<double>(n_ - 1) : 0.0; }

 private:
  std::int64_t n_ = 0;
  double mean_s_ = 0.0;
  double m2_s2_ = 0.0;
};

/// A duration still to come, with the variance of its estimate.
struct Remaining {
  double time_s = 0.0;
  double variance_s2 = 0.0;
};

/// `left` more of what was measured: n * mean; variance n s^2 of the sum plus n^2 s^2 / m of the mean.
[[nodiscard]] Remaining remaining(const DurationStatistics& measured, std::int64_t left);

TimeParts& operator+=(TimeParts& sum, const TimeParts& more);

/// What a scan has left to do.
struct WorkLeft {
  std::int64_t samples = 0;     ///< items
  std::int64_t references = 0;  ///< items
  double way_s = 0.0;           ///< by the model, along the order: moves and settling, without turns
  double u_way_s = 0.0;         ///< of what the model has not looked at yet
  double turns_s = 0.0;         ///< by the model, between sample and reference
  double u_turns_s = 0.0;
  Duration dark_every{};    ///< zero: at the end only
  Duration dark_light{};    ///< exposures of the next dark
  Duration other_visits{};  ///< still to come, of other kinds
};

/// What a scan still takes, from what its items took: light, frames and idle by the mean of each target; moves by the
/// model, corrected by what those before took beside it; turns between sample and reference, and darks, by themselves.
/// The first item of each target is left out as soon as there is another: it probes for its exposure. Waits for
/// the store are those of late: a disk that others use has hours of its own. Time in holds and
/// of devices that failed says nothing about what is to come.
class EndEstimate {
 public:
  /// `is_turn`: the item before was of the other target.
  void add_item(calibration::Target target, const TimeParts& took, const StepTime& model, bool is_turn);
  void add_dark(const TimeParts& took);
  /// What past scans took for moves and settling, beside the axes' numbers: counts as much as the first minute of its
  /// own.
  void expect_motion(double ratio);
  /// Whether there is anything to judge by.
  [[nodiscard]] bool is_ready() const { return sample_.count() + reference_.count() > 0; }
  [[nodiscard]] Remaining of(const WorkLeft& left) const;
  /// Of a sample item, beyond moving and settling.
  [[nodiscard]] double sample_work_s() const { return (sample_.count() > 0 ? sample_ : reference_).mean_s(); }

 private:
  [[nodiscard]] Remaining work_of(const WorkLeft& left) const;
  [[nodiscard]] Remaining way_of(const WorkLeft& left) const;
  [[nodiscard]] Remaining darks_of(const WorkLeft& left, double items_s) const;
  [[nodiscard]] double ratio() const { return by_model_s_ > 0.0 ? took_s_ / by_model_s_ : 1.0; }

  DurationStatistics sample_;     ///< beyond moving and settling
  DurationStatistics reference_;  ///< likewise
  DurationStatistics dark_beyond_light_;
  bool only_first_sample_ = false;
  bool only_first_reference_ = false;
  double commit_s_ = 0.0;  ///< an item's wait for the store, lately
  double took_s_ = 0.0;    ///< moves and settling that were no turns
  double by_model_s_ = 0.0;
};

}  // namespace gonio::daemon
