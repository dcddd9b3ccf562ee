#include "daemon/results/transfer_run.h"

#include <gtest/gtest.h>

#include <numbers>

namespace gonio::daemon {
namespace {

using std::numbers::pi;

// 0/45 twice at 480 nm and once at 568 nm, and 0/20, which no certificate speaks of.
calibration::ScanReadings plan() {
  const auto at = [](std::int32_t index, double theta_r, double phi_r, double nm) {
    return calibration::PlannedPoint{
        .index = index,
        .geometry = {.theta_i = {}, .phi_i = {}, .theta_r = degrees(theta_r), .phi_r = degrees(phi_r)},
        .wavelength = nanometres(nm)};
  };
  calibration::ScanReadings scan;
  scan.points = {at(0, 45, 0, 480), at(1, 45, 90, 480), at(2, 20, 0, 480), at(3, 45, 0, 568)};
  return scan;
}

NewBrdf brdf_of_points(int points) {
  NewBrdf brdf;
  brdf.component_names = {"certificate [shared, u in 1]"};
  for (int k = 0; k < points; ++k) {
    const double reff = 0.9 + 0.02 * k;
    brdf.rows.push_back({.point = k, .value_per_sr = reff / pi, .sensitivities_per_sr = {0, 0.01 / pi}});
  }
  return brdf;
}

TEST(TransferRun, TakesTheMeanAt0To45OfEachWavelengthWithTheMastersSharedUncertainty) {
  const auto found = transfer_of(brdf_of_points(4), plan(), "SRT-99-020");

  ASSERT_TRUE(found) << describe(found.error());
  ASSERT_EQ(found->values.size(), 2U);
  EXPECT_EQ(found->values[0].name, "reff_0_45_480nm");
  EXPECT_NEAR(found->values[0].value, 0.91, 1e-12);
  EXPECT_EQ(found->values[1].name, "reff_0_45_568nm");
  EXPECT_NEAR(found->values[1].value, 0.96, 1e-12);
  EXPECT_NEAR(found->u(0), 0.01, 1e-12) << "shared: no mean makes it smaller";
  EXPECT_NEAR(found->correlation(0, 1), 1.0, 1e-12);
  EXPECT_NE(found->note.find("SRT-99-020"), std::string::npos);
}

TEST(TransferRun, NamesTheWavelengthThatHasNoValueThere) {
  const auto found = transfer_of(brdf_of_points(3), plan(), "SRT-99-020");

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::IncompleteData);
  EXPECT_NE(found.error().tried.find("568 nm"), std::string::npos) << found.error().tried;
}

}  // namespace
}  // namespace gonio::daemon
