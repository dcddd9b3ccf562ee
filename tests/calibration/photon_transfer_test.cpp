#include "calibration/photon_transfer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gonio::calibration {
namespace {

using Pixels = std::vector<std::uint16_t>;

constexpr std::size_t kPixels = 64 * 64;
constexpr std::uint64_t kSeed = 7;

TEST(PhotonTransfer, TakesTheNoiseOfAPairFromItsDifference) {
  const auto pair = pair_of(Pixels{10, 20, 30, 40}, Pixels{12, 18, 32, 38});  // differences -2, 2, -2, 2

  ASSERT_TRUE(pair);
  EXPECT_DOUBLE_EQ(pair->mean_dn, 25.0);
  EXPECT_DOUBLE_EQ(pair->variance_dn2, 0.5 * 16.0 / 3.0);
  EXPECT_EQ(pair->n, 4U);
}

TEST(PhotonTransfer, DoesNotTakeAChangeOfTheLampForNoise) {
  const auto pair = pair_of(Pixels{10, 20, 30, 40}, Pixels{15, 25, 35, 45});

  ASSERT_TRUE(pair);
  EXPECT_DOUBLE_EQ(pair->variance_dn2, 0.0);
}

TEST(PhotonTransfer, RefusesFramesOfUnlikeSize) {
  EXPECT_EQ(pair_of(Pixels{1, 2}, Pixels{1, 2, 3}).error().code, ErrorCode::IncompleteData);
}

TEST(PhotonTransfer, FindsTheConstantsOfALineWithoutScatter) {
  // 4 e-/DN, read noise 1.5 DN, offset 100 DN
  const auto at = [](double light) { return FramePair{100.0 + light, 2.25 + light / 4.0, 1000}; };

  const auto found = photon_transfer(at(0.0), {at(100.0), at(400.0), at(1600.0)});

  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_NEAR(found->electrons_per_dn.value, 4.0, 1e-9);
  EXPECT_NEAR(found->read_noise_dn.value, 1.5, 1e-9);
}

/// A pair of frames of a detector with a fixed pattern of 2 %: Poisson electrons, normal read noise, whole DN.
FramePair simulated_pair(std::mt19937_64& chance, double electrons, double electrons_per_dn, double read_noise_dn) {
  std::normal_distribution<double> normal;
  Pixels first, second;
  for (std::size_t k = 0; k < kPixels; ++k) {
    const double mean = electrons * (1.0 + 0.02 * std::sin(static_cast<double>(k)));
    for (Pixels* frame : {&first, &second}) {
      const double caught = mean > 0.0 ? std::poisson_distribution<int>(mean)(chance) : 0.0;
      frame->push_back(
          static_cast<std::uint16_t>(std::lround(100.0 + caught / electrons_per_dn + read_noise_dn * normal(chance))));
    }
  }
  return *pair_of(first, second);
}

// Over 40 repetitions the estimates must scatter about the truth as their stated uncertainties say. Rounding adds 1/12
// DN^2.
TEST(PhotonTransfer, IsTrueOfSimulatedFramesWithinItsUncertainty) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 chance(kSeed);
  constexpr int kRepeats = 40;
  const double read = std::sqrt(1.5 * 1.5 + 1.0 / 12.0);
  double gain2 = 0.0, read2 = 0.0;
  for (int k = 0; k < kRepeats; ++k) {
    const FramePair dark = simulated_pair(chance, 0.0, 4.0, 1.5);
    std::vector<FramePair> lit;
    for (const double electrons : {400.0, 1600.0, 6400.0}) lit.push_back(simulated_pair(chance, electrons, 4.0, 1.5));

    const auto found = photon_transfer(dark, lit);

    ASSERT_TRUE(found) << describe(found.error());
    gain2 += std::pow((found->electrons_per_dn.value - 4.0) / found->electrons_per_dn.u, 2) / kRepeats;
    read2 += std::pow((found->read_noise_dn.value - read) / found->read_noise_dn.u, 2) / kRepeats;
  }
  // chi^2 / 40 lies in 0.45..1.85 but once in 1000.
  EXPECT_GT(gain2, 0.45);
  EXPECT_LT(gain2, 1.85);
  EXPECT_GT(read2, 0.45);
  EXPECT_LT(read2, 1.85);
}

TEST(PhotonTransfer, RefusesPairsThatShowNoGain) {
  const FramePair dark{100.0, 2.0, 1000};

  EXPECT_EQ(photon_transfer(dark, {}).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(photon_transfer(dark, {FramePair{100.0, 2.0, 1000}}).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(photon_transfer(dark, {FramePair{900.0, 1.0, 1000}}).error().code, ErrorCode::OutOfLimits);
}

}  // namespace
}  // namespace gonio::calibration
