#pragma once

#include <cstdint>
#include <limits>

namespace gonio::sim {

/// What a draw is for. The number is part of the key, so it never changes meaning.
enum class Purpose : std::uint32_t {
  ZeroError = 1,    ///< counter: axis
  RepeatError = 2,  ///< counter: move, axis
  Certificate = 3,
  ShapeMode = 4,  ///< counter: mode
  Linearity = 5,
  LampPhase = 6,
  Flicker = 7,           ///< counter: cell of scene time
  MonitorDrift = 8,      ///< counter: component
  MonitorNoise = 9,      ///< counter: exposure
  MonitorNow = 10,       ///< counter: cell of scene time
  Placing = 11,          ///< counter: move
  Pixels = 12,           ///< counter: exposure
  Radiometer = 13,       ///< counter: meter, sample
  RadiometerRange = 14,  ///< counter: meter, range
  DarkWander = 21,       ///< counter: component
  OffsetWander = 22,     ///< counter: component
  Speckle = 23,          ///< counter: place
  PixelPattern = 24,
  Stop = 25,        ///< counter: radius, distance
  Attenuator = 26,  ///< counter: slot
};

/// A stream of chance that depends on nothing but (seed, purpose, counter): how often one effect draws never shifts
/// another, and the n-th exposure has the same noise however it was reached. A UniformRandomBitGenerator: SplitMix64
/// (Steele, Lea and Flood 2014) started from the hashed key.
class Chance {
 public:
  using result_type = std::uint64_t;

  Chance(std::uint64_t seed, Purpose purpose, std::uint64_t counter = 0);

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()();

  /// In (0, 1).
  double uniform();
  /// Mean 0, standard deviation 1.
  double normal();
  /// Chi-squared; `degrees_of_freedom` > 0.
  double chi_squared(double degrees_of_freedom);
  /// `mean` >= 0.
  double poisson(double mean);

 private:
  std::uint64_t state_;
};

}  // namespace gonio::sim
