#include "daemon/planner/step_price.h"

#include <algorithm>
#include <cmath>

namespace gonio::daemon {

using stage::Axis;

namespace {

/// Axes that go the same part of their ways in the same time (drivers/motion/leg_axes.h).
struct SharedWay {
  double per_speed_s = 0.0;          ///< the largest distance / speed
  double per_acceleration_s2 = 0.0;  ///< the largest distance / acceleration

  void add(double distance, double speed, double acceleration) {
    per_speed_s = std::max(per_speed_s, distance / speed);
    per_acceleration_s2 = std::max(per_acceleration_s2, distance / acceleration);
  }
  [[nodiscard]] double time_s() const {
    return per_speed_s * per_speed_s >= per_acceleration_s2 && per_speed_s > 0.0
               ? per_speed_s + per_acceleration_s2 / per_speed_s
               : 2.0 * std::sqrt(per_acceleration_s2);
  }
};

}  // namespace

StepPrice::StepPrice(const Instrument& instrument, std::span<const Place> places)
    : is_coordinated_(instrument.stage.coordinated) {
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = stage::index_of(axis);
    const drivers::AxisConfig& how = instrument.stage.axis(axis);
    settle_of_all_s_ = std::max(settle_of_all_s_, in_seconds(how.settle));
    const auto differs = [&](const Place& place) { return place[a] != places.front()[a]; };
    if (std::ranges::none_of(places, differs)) continue;
    AxisPrice price{.place = a,
                    .speed = how.speed,
                    .acceleration = how.acceleration,
                    .ramps = how.speed * how.speed / how.acceleration,
                    .ramps_s = how.speed / how.acceleration,
                    .settle_s = in_seconds(how.settle),
                    .window = how.window};
    if (how.approach != drivers::Approach::Any) {
      price.side = how.approach == drivers::Approach::FromBelow ? 1.0 : -1.0;
      price.overrun = how.overrun;
      price.overrun_s = travel_s(price, how.overrun);
      has_sides_ = true;
    }
    axes_.push_back(a);
    prices_.push_back(price);
  }
}

double StepPrice::travel_s(const AxisPrice& axis, double distance) {
  return distance >= axis.ramps ? distance / axis.speed + axis.ramps_s : 2.0 * std::sqrt(distance / axis.acceleration);
}

double StepPrice::way_s(const Place& from, const Place& to) const {
  SharedWay first;
  SharedWay last;
  double first_s = 0.0;
  double last_s = 0.0;
  double settle_s = 0.0;
  for (const AxisPrice& axis : prices_) {
    const double way = to[axis.place] - from[axis.place];
    if (way == 0.0) continue;
    double distance = std::abs(way);
    if (way * axis.side < -axis.window) {
      distance += axis.overrun;
      last_s = std::max(last_s, axis.overrun_s);
      if (is_coordinated_) last.add(axis.overrun, axis.speed, axis.acceleration);
    }
    if (is_coordinated_)
      first.add(distance, axis.speed, axis.acceleration);
    else
      first_s = std::max(first_s, travel_s(axis, distance));
    settle_s = std::max(settle_s, axis.settle_s);
  }
  if (is_coordinated_) {
    first_s = first.time_s();
    last_s = last.time_s();
  }
  return first_s + last_s + (last_s > 0.0 ? settle_of_all_s_ : settle_s);
}

double StepPrice::mean_s(const Place& a, const Place& b) const {
  return has_sides_ ? 0.5 * (way_s(a, b) + way_s(b, a)) : way_s(a, b);
}

double StepPrice::least_s(std::size_t axis, double distance) const {
  return travel_s(prices_[axis], std::abs(distance));
}

}  // namespace gonio::daemon
