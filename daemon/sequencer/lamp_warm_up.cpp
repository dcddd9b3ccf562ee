#include "daemon/sequencer/lamp_warm_up.h"

#include <algorithm>
#include <cmath>

namespace gonio::daemon {

namespace {

constexpr int kValuesOver = 60;  // wanted within `over`
constexpr int kDensest = 4;      // of that density, what is kept
constexpr int kWidestGap = 4;    // of `over`, as a part
constexpr Duration kLeastSampling = std::chrono::milliseconds(100);
constexpr std::size_t kFewest = 8;  // a scatter about a line means nothing below

}  // namespace

Duration LampWatch::sampling() const {
  return wanted_ ? std::max(kLeastSampling, wanted_->over / kValuesOver) : Duration::zero();
}

void LampWatch::see(double monitor, Instant now) {
  if (!wanted_) return;
  if (!seen_.empty() && now - seen_.back().at > wanted_->over / kWidestGap) seen_.clear();
  if (!seen_.empty() && now - seen_.back().at < sampling() / kDensest) return;
  seen_.push_back({now, monitor});
  // One value before the window stays: with it the window is covered.
  while (seen_.size() > 2 && now - seen_[1].at >= wanted_->over) seen_.pop_front();
}

std::optional<LampWatch::Slope> LampWatch::slope(Instant now) const {
  if (!wanted_ || seen_.size() < kFewest || still_to_see(now) > Duration::zero()) return std::nullopt;
  const auto n = static_cast<double>(seen_.size());
  double mean_t = 0.0;
  double mean_y = 0.0;
  for (const Value& value : seen_) {
    mean_t += in_seconds(value.at - seen_.front().at) / n;
    mean_y += value.monitor / n;
  }
  double tt = 0.0;
  double ty = 0.0;
  double yy = 0.0;
  for (const Value& value : seen_) {
    const double t = in_seconds(value.at - seen_.front().at) - mean_t;
    const double y = value.monitor - mean_y;
    tt += t * t;
    ty += t * y;
    yy += y * y;
  }
  if (mean_y <= 0.0) return std::nullopt;
  const double per_s = ty / tt;
  const double scatter = std::max(0.0, yy - per_s * ty) / (n - 2.0);
  return Slope{.per_s = std::abs(per_s) / mean_y, .u_per_s = std::sqrt(scatter / tt) / mean_y};
}

bool LampWatch::is_warm(Instant now) const {
  if (!wanted_) return true;
  const auto found = slope(now);
  constexpr double kSure = 2.0;
  return found && found->per_s + kSure * found->u_per_s < wanted_->slope_per_s;
}

std::optional<double> LampWatch::slope_per_s(Instant now) const {
  const auto found = slope(now);
  if (!found) return std::nullopt;
  return found->per_s;
}

Duration LampWatch::still_to_see(Instant now) const {
  if (!wanted_) return Duration::zero();
  const bool is_broken = seen_.empty() || now - seen_.back().at > wanted_->over / kWidestGap;
  if (is_broken) return wanted_->over;
  return std::max(Duration::zero(), wanted_->over - (seen_.back().at - seen_.front().at));
}

}  // namespace gonio::daemon
