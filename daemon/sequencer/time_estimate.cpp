#include "daemon/sequencer/time_estimate.h"

namespace gonio::daemon {

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

}  // namespace gonio::daemon
