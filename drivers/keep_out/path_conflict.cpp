#include "drivers/keep_out/path_conflict.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/kinematics/kinematics.h"
#include "drivers/motion/axis_profile.h"
#include "drivers/motion/leg_axes.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using stage::index_of;

struct Moment {
  double after_s = 0.0;
  stage::PerAxis<double> at{};
  double xi = 0.0;  ///< rad
};

double travel(const Moment& a, const Moment& b, Axis axis) {
  return degrees(std::abs(b.at[index_of(axis)] - a.at[index_of(axis)])).si();
}

// The largest |sin| of an angle that goes monotonely from one value to the other.
double largest_sine(double from_deg, double to_deg) {
  const double low = std::min(std::abs(from_deg), std::abs(to_deg));
  const double high = std::max(std::abs(from_deg), std::abs(to_deg));
  if (high >= 90.0 && low <= 90.0) return 1.0;
  return std::max(std::abs(std::sin(degrees(low).si())), std::abs(std::sin(degrees(high).si())));
}

class Path {
 public:
  Path(const StageConfig& config, const stage::PerAxis<double>& from, const MotionTarget& to) : config_(config) {
    const stage::PerAxis<AxisConfig> axes = axes_on_leg(config, from, to);
    for (std::size_t a = 0; a < stage::kAxisCount; ++a) {
      profiles_[a] = AxisProfile(from[a], to[a].value_or(from[a]), axes[a]);
      end_s_ = std::max(end_s_, profiles_[a].duration_s());
    }
  }

  [[nodiscard]] double end_s() const { return end_s_; }

  [[nodiscard]] Moment moment(double after_s) const {
    Moment m{.after_s = after_s};
    for (std::size_t a = 0; a < stage::kAxisCount; ++a) m.at[a] = profiles_[a].position(after_s);
    m.xi = separation(config_.kinematics, m.at).si();
    return m;
  }

  // By how much xi may have changed on the way from one moment to the other.
  [[nodiscard]] double bound(const Moment& a, const Moment& b) const {
    if (config_.kinematics.kind == KinematicsKind::TurningSample) {
      return travel(a, b, config_.kinematics.turning.detector_arm);
    }
    const auto sine = [&](Axis axis) { return largest_sine(a.at[index_of(axis)], b.at[index_of(axis)]); };
    return travel(a, b, Axis::ThetaI) + travel(a, b, Axis::ThetaR) +
           std::min(sine(Axis::ThetaI), sine(Axis::ThetaR)) * (travel(a, b, Axis::PhiI) + travel(a, b, Axis::PhiR));
  }

 private:
  const StageConfig& config_;
  stage::PerAxis<AxisProfile> profiles_;
  double end_s_ = 0.0;
};

}  // namespace

std::optional<PathConflict> path_conflict(const StageConfig& config, const stage::PerAxis<double>& from,
                                          const MotionTarget& to) {
  if (!config.keep_out) return std::nullopt;
  const Path path(config, from, to);
  const Moment start = path.moment(0.0);
  const Moment end = path.moment(path.end_s());
  const auto conflict = [](const Moment& m, double least) {
    return PathConflict{.at = m.at, .separation = radians(m.xi), .least = radians(least)};
  };
  if (path.bound(start, end) == 0.0) return std::nullopt;
  const double asked = config.keep_out->least_separation().si();
  if (end.xi < asked) return conflict(end, asked);
  const double resolution = kPathResolution.si();
  const double least =
      start.xi < asked + resolution ? std::max(0.0, std::min(asked, start.xi) - 2.0 * resolution) : asked;
  // In the order of time: the last on the stack is the earliest interval.
  std::vector<std::pair<Moment, Moment>> open{{start, end}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const double bound = path.bound(a, b);
    if (0.5 * (a.xi + b.xi - bound) >= least) continue;
    const Moment middle = path.moment(0.5 * (a.after_s + b.after_s));
    if (middle.xi < least || bound < resolution) return conflict(middle, asked);
    open.emplace_back(middle, b);
    open.emplace_back(a, middle);
  }
  return std::nullopt;
}

}  // namespace gonio::drivers
