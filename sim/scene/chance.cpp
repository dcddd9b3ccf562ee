#include "sim/scene/chance.h"

#include <random>

namespace gonio::sim {
namespace {

constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ULL;  // 2^64 / golden ratio: SplitMix64's step

constexpr std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

}  // namespace

Chance::Chance(std::uint64_t seed, Purpose purpose, std::uint64_t counter)
    : state_(mixed(mixed(mixed(seed + kGolden) + static_cast<std::uint64_t>(purpose)) + counter)) {}

Chance::result_type Chance::operator()() {
  state_ += kGolden;
  return mixed(state_);
}

double Chance::uniform() {
  constexpr double kStep = 0x1.0p-53;
  return (static_cast<double>((*this)() >> 11U) + 0.5) * kStep;
}

double Chance::normal() {
  return std::normal_distribution<double>()(*this);
}

double Chance::chi_squared(double degrees_of_freedom) {
  return std::chi_squared_distribution<double>(degrees_of_freedom)(*this);
}

double Chance::poisson(double mean) {
  if (mean <= 0.0) return 0.0;
  return static_cast<double>(std::poisson_distribution<std::int64_t>(mean)(*this));
}

}  // namespace gonio::sim
