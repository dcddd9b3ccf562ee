#include "reflectance/check/hard_pairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

class PairMaker {
 public:
  explicit PairMaker(std::uint64_t seed) : engine_(seed) {}

  DirectionPair next() {
    const double gap = distance();
    switch (engine_() % 10) {
      case 0:
        return {.i = Direction::from_angles(radians(gap), azimuth()), .r = anywhere()};
      case 1:
        return {.i = Direction::from_elevation(radians(gap), azimuth()), .r = anywhere()};
      case 2: {
        const Direction i = anywhere();
        return {.i = i, .r = near(i, gap)};
      }
      case 3: {
        const Direction i = anywhere();
        return {.i = i, .r = near(mirrored(i), gap)};
      }
      case 4: {
        const Direction i = Direction::from_elevation(radians(distance()), azimuth());
        return {.i = i, .r = near(mirrored(i), gap)};
      }
      default:
        return {.i = anywhere(), .r = anywhere()};
    }
  }

 private:
  double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  double distance() { return engine_() % 16 == 0 ? 0.0 : std::pow(10.0, -14.0 * unit()); }
  Angle azimuth() { return radians(2.0 * kPi * (unit() - 0.5)); }
  Direction anywhere() { return Direction::from_angles(radians(0.5 * kPi * unit()), azimuth()); }

  Direction near(const Direction& d, double gap) {
    const Angle phi = d.phi() + radians(gap * (unit() - 0.5));
    const Angle theta = d.theta() + radians(gap * (unit() - 0.5));
    return Direction::from_angles(std::clamp(theta, Angle{}, radians(0.5 * kPi)), phi);
  }

  std::mt19937_64 engine_;
};

}  // namespace

std::vector<DirectionPair> hard_pairs(std::size_t count, std::uint64_t seed) {
  PairMaker maker(seed);
  std::vector<DirectionPair> pairs;
  pairs.reserve(count);
  for (std::size_t k = 0; k < count; ++k) pairs.push_back(maker.next());
  return pairs;
}

}  // namespace gonio::reflectance
