#include "drivers/keep_out/detour.h"

#include <algorithm>
#include <array>

#include "drivers/keep_out/path_conflict.h"
#include "drivers/motion/route_time.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using stage::index_of;
using Legs = std::vector<MotionTarget>;

constexpr std::array<Axis, 4> kTurningAxes{Axis::ThetaI, Axis::ThetaR, Axis::PhiR, Axis::PhiI};
constexpr std::array<double, 8> kSwings_deg{30.0, -30.0, 60.0, -60.0, 120.0, -120.0, 180.0, -180.0};

class DetourSearch {
 public:
  DetourSearch(const StageConfig& config, const stage::PerAxis<double>& from, const MotionTarget& to)
      : config_(config), from_(from), to_(to) {}

  std::optional<Legs> run() {
    some_axes_first();
    for (const Axis arm : {Axis::ThetaR, Axis::ThetaI}) {
      aside(arm, config_.axis(arm).high);
      aside(arm, config_.axis(arm).low);
    }
    for (const double swing : kSwings_deg) {
      aside(Axis::PhiR, from_[index_of(Axis::PhiR)] + swing);
      aside(Axis::PhiR, end(Axis::PhiR) + swing);
    }
    return best_;
  }

 private:
  [[nodiscard]] double end(Axis axis) const { return *to_[index_of(axis)]; }

  // All named axes; those of the mask already at their end, the other turning axes still where they stand.
  [[nodiscard]] MotionTarget with_at_end(unsigned mask) const {
    MotionTarget leg = to_;
    for (const Axis axis : kTurningAxes) {
      const std::size_t a = index_of(axis);
      if ((mask >> a & 1U) == 0) leg[a] = from_[a];
    }
    return leg;
  }

  void some_axes_first() {
    unsigned moving = 0;
    for (const Axis axis : kTurningAxes) {
      if (end(axis) != from_[index_of(axis)]) moving |= 1U << index_of(axis);
    }
    for (unsigned mask = (moving - 1) & moving; mask != 0; mask = (mask - 1) & moving) offer({with_at_end(mask), to_});
  }

  // One axis goes aside, all others go to their ends, the axis comes to its own.
  void aside(Axis axis, double position) {
    const std::size_t a = index_of(axis);
    if (position < config_.axis(axis).low || position > config_.axis(axis).high) return;
    MotionTarget first = with_at_end(0);
    first[a] = position;
    MotionTarget second = to_;
    second[a] = position;
    offer({first, second, to_});
  }

  void offer(const Legs& legs) {
    const Duration time = route_time(config_, from_, legs);
    if (best_ && time >= best_time_) return;
    stage::PerAxis<double> at = from_;
    for (const MotionTarget& leg : legs) {
      if (path_conflict(config_, at, leg)) return;
      at = after(at, leg);
    }
    best_ = legs;
    best_time_ = time;
  }

  const StageConfig& config_;
  const stage::PerAxis<double>& from_;
  const MotionTarget& to_;
  std::optional<Legs> best_;
  Duration best_time_{};
};

}  // namespace

std::optional<Legs> detour(const StageConfig& config, const stage::PerAxis<double>& from, const MotionTarget& to) {
  if (config.kinematics.kind != KinematicsKind::Arms) return std::nullopt;  // one arm: there is no other way
  return DetourSearch(config, from, to).run();
}

}  // namespace gonio::drivers
