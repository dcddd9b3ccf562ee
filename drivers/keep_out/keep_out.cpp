#include "drivers/keep_out/keep_out.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gonio::drivers {
namespace {

constexpr int kHalvings = 60;

// From the head's axis to the point at distance s on a ray at this angle to it.
double squared_distance(double s, const ArmHead& head, double cosine, double half_sine) {
  const double t = std::clamp(s * cosine, head.nearest.si(), head.farthest.si());
  return (s - t) * (s - t) + 4.0 * s * t * half_sine * half_sine;
}

}  // namespace

KeepOut::KeepOut(const ArmHead& source, const ArmHead& detector, Length margin) : source_(source), detector_(detector) {
  Angle meets;
  Angle clear = radians(std::numbers::pi);
  if (clearance(meets) >= margin) clear = meets;
  for (int k = 0; k < kHalvings && meets < clear; ++k) {
    const Angle middle = 0.5 * (meets + clear);
    (clearance(middle) >= margin ? clear : meets) = middle;
  }
  least_ = clear;
}

Length KeepOut::clearance(Angle separation) const {
  const double cosine = std::cos(separation.si());
  const double half_sine = std::sin(0.5 * separation.si());
  // The two axes meet at the sample only, outside of both: the shortest way ends at an end of one of them.
  const double least = std::min({squared_distance(source_.nearest.si(), detector_, cosine, half_sine),
                                 squared_distance(source_.farthest.si(), detector_, cosine, half_sine),
                                 squared_distance(detector_.nearest.si(), source_, cosine, half_sine),
                                 squared_distance(detector_.farthest.si(), source_, cosine, half_sine)});
  return Length::from_si(std::sqrt(least)) - source_.radius - detector_.radius;
}

}  // namespace gonio::drivers
