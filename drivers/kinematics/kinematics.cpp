#include "drivers/kinematics/kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "drivers/kinematics/turning_sample.h"
#include "drivers/motion/leg_axes.h"

namespace gonio::drivers {
namespace {

using stage::Axis;
using stage::index_of;

// Encoders and lists carry rounding: a value so little beyond a limit stands on it.
constexpr double kLimitSlack = 1e-9;
constexpr double kTurn_deg = 360.0;

Angle angle_at(const stage::PerAxis<double>& positions, Axis axis) {
  return degrees(positions[index_of(axis)]);
}

SampleTurns turns_at(const TurningSample& sample, const stage::PerAxis<double>& positions) {
  return {.yaw = angle_at(positions, sample.yaw),
          .pitch = angle_at(positions, sample.pitch),
          .roll = angle_at(positions, sample.roll),
          .detector = angle_at(positions, sample.detector_arm)};
}

double beyond(const AxisConfig& axis, double position) {
  return std::max({0.0, axis.low - position, position - axis.high});
}

// The same angle by whole turns: all that lie within the limits, or else the one that comes nearest to them.
std::vector<double> turns_within(const AxisConfig& axis, double position) {
  const double first = std::ceil((axis.low - kLimitSlack - position) / kTurn_deg);
  const double last = std::floor((axis.high + kLimitSlack - position) / kTurn_deg);
  std::vector<double> all;
  for (double turn = first; turn <= last; turn += 1.0) {
    all.push_back(std::clamp(position + kTurn_deg * turn, axis.low, axis.high));
  }
  if (!all.empty()) return all;
  const double under = position + kTurn_deg * last;
  const double over = position + kTurn_deg * first;
  return {beyond(axis, under) < beyond(axis, over) ? under : over};
}

double nearest_to(const std::vector<double>& positions, double standing) {
  return *std::ranges::min_element(positions, {}, [&](double p) { return std::abs(p - standing); });
}

// One way to stand, with how long it takes to get there and how far beyond its limits the worst axis would be.
struct Way {
  MotionTarget target{};
  Duration travel{};
  double worst_beyond = 0.0;
  Axis worst_axis = Axis::ThetaI;
};

class WayBuilder {
 public:
  WayBuilder(const StageConfig& config, const stage::PerAxis<double>& standing)
      : config_(config), standing_(standing) {}

  void put(Axis axis, double position) {
    const std::size_t a = index_of(axis);
    const AxisConfig& how = config_.axes[a];
    way_.target[a] = position;
    if (const double b = beyond(how, position); b > kLimitSlack && b > way_.worst_beyond) {
      way_.worst_beyond = b;
      way_.worst_axis = axis;
    } else if (b <= kLimitSlack) {
      way_.target[a] = std::clamp(position, how.low, how.high);
    }
  }
  [[nodiscard]] Way way() const {
    Way way = way_;
    way.travel = leg_time(config_, standing_, way.target);
    return way;
  }

 private:
  const StageConfig& config_;
  const stage::PerAxis<double>& standing_;
  Way way_;
};

std::vector<Way> ways_of_arms(const Geometry& g, const StageConfig& config, const stage::PerAxis<double>& standing) {
  std::vector<Way> ways;
  for (const double phi_r : turns_within(config.axis(Axis::PhiR), in_degrees(g.phi_r))) {
    for (const double phi_i : turns_within(config.axis(Axis::PhiI), in_degrees(g.phi_i))) {
      WayBuilder way(config, standing);
      way.put(Axis::ThetaI, in_degrees(g.theta_i));
      way.put(Axis::ThetaR, in_degrees(g.theta_r));
      way.put(Axis::PhiR, phi_r);
      way.put(Axis::PhiI, phi_i);
      ways.push_back(way.way());
    }
  }
  return ways;
}

Result<std::vector<Way>> ways_of_sample(const Geometry& g, const StageConfig& config,
                                        const stage::PerAxis<double>& standing) {
  const TurningSample& sample = config.kinematics.turning;
  const auto all = turns_for(sample, g, turns_at(sample, standing));
  if (!all) return failure(all.error());
  std::vector<Way> ways;
  for (const SampleTurns& turns : *all) {
    WayBuilder way(config, standing);
    for (const auto& [axis, angle] :
         {std::pair(sample.yaw, turns.yaw), std::pair(sample.pitch, turns.pitch), std::pair(sample.roll, turns.roll),
          std::pair(sample.detector_arm, turns.detector)}) {
      way.put(axis, nearest_to(turns_within(config.axis(axis), in_degrees(angle)), standing[index_of(axis)]));
    }
    ways.push_back(way.way());
  }
  return ways;
}

Error beyond_limit(const StageConfig& config, const Way& way) {
  const AxisConfig& how = config.axis(way.worst_axis);
  const double position = *way.target[index_of(way.worst_axis)];
  const auto unit = stage::axis_unit(way.worst_axis);
  return {.code = ErrorCode::OutOfLimits,
          .device = "stage",
          .tried = fmt::format("move {} to {:.3f} {}", stage::axis_name(way.worst_axis), position, unit),
          .seen = fmt::format("target {:.3f} {}", position, unit),
          .limit = fmt::format("{:.3f} to {:.3f} {}", how.low, how.high, unit)};
}

// Whole turns do not change a direction.
Angle within_half_a_turn(Angle phi, Angle planned) {
  return planned + wrapped(phi - planned);
}

}  // namespace

Geometry directions(const KinematicsConfig& kinematics, const stage::PerAxis<double>& positions) {
  if (kinematics.kind == KinematicsKind::TurningSample) {
    return directions_of(kinematics.turning, turns_at(kinematics.turning, positions));
  }
  return {.theta_i = angle_at(positions, Axis::ThetaI),
          .phi_i = angle_at(positions, Axis::PhiI),
          .theta_r = angle_at(positions, Axis::ThetaR),
          .phi_r = angle_at(positions, Axis::PhiR)};
}

Geometry directions_near(const KinematicsConfig& kinematics, const stage::PerAxis<double>& positions,
                         const Geometry& planned) {
  Geometry g = directions(kinematics, positions);
  g.phi_i = within_half_a_turn(g.phi_i, planned.phi_i);
  g.phi_r = within_half_a_turn(g.phi_r, planned.phi_r);
  return g;
}

Angle separation(const KinematicsConfig& kinematics, const stage::PerAxis<double>& positions) {
  if (kinematics.kind == KinematicsKind::TurningSample) {
    return separation_of(kinematics.turning, angle_at(positions, kinematics.turning.detector_arm));
  }
  return phase_angle(directions(kinematics, positions));
}

Result<std::vector<MotionTarget>> solutions(const Geometry& g, const StageConfig& config,
                                            const stage::PerAxis<double>& standing) {
  auto ways = config.kinematics.kind == KinematicsKind::TurningSample
                  ? ways_of_sample(g, config, standing)
                  : Result<std::vector<Way>>(ways_of_arms(g, config, standing));
  if (!ways) return failure(ways.error());
  std::ranges::stable_sort(*ways, {}, [](const Way& w) { return std::pair(w.worst_beyond, w.travel); });
  if (ways->front().worst_beyond > 0.0) return failure(beyond_limit(config, ways->front()));
  std::vector<MotionTarget> targets;
  for (const Way& way : *ways) {
    if (way.worst_beyond == 0.0) targets.push_back(way.target);
  }
  return targets;
}

}  // namespace gonio::drivers
