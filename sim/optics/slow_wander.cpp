#include "sim/optics/slow_wander.h"

#include <cmath>
#include <numbers>

namespace gonio::sim {

SlowWander::SlowWander(std::uint64_t seed, Purpose purpose, double correlation_s) {
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    Chance chance(seed, purpose, k);
    waves_[k].frequency = chance.normal() / correlation_s;
    waves_[k].phase = 2.0 * std::numbers::pi * chance.uniform();
  }
}

double SlowWander::at(double scene_s, double deviation) const {
  const double amplitude = deviation * std::sqrt(2.0 / static_cast<double>(waves_.size()));  // a wave has variance 1/2
  double sum = 0.0;
  for (const Wave& wave : waves_) sum += std::cos(wave.frequency * scene_s + wave.phase);
  return amplitude * sum;
}

}  // namespace gonio::sim
