#include "daemon/results/version_desk.h"

#include <gtest/gtest.h>

#include "tests/daemon/support/bench_instrument.h"

namespace gonio::daemon {
namespace {

FoundCalibration zeros(CalibrationVersion version, double theta_i_deg, bool counts = false) {
  FoundCalibration found{.version = version, .job = "arm-zeros", .inputs_json = "{}"};
  found.found.values = {
      {"zero_theta_i_deg", "deg", theta_i_deg}, {"zero_theta_r_deg", "deg", 0.0}, {"zero_phi_r_deg", "deg", 0.0}};
  found.found.covariance = {1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 1e-4};
  found.counts = counts;
  return found;
}

FoundCalibration bend(CalibrationVersion version, const std::string& detector) {
  FoundCalibration found{.version = version, .job = "linearity", .inputs_json = "{\"detector\":\"" + detector + "\"}"};
  found.found.values = {{"linearity_1", "1", 0.02}, {"exposure_offset_s", "s", 1e-5}};
  found.found.covariance = {1e-6, 0.0, 0.0, 1e-12};
  return found;
}

AskedVersions these(std::vector<CalibrationVersion> versions) {
  return versions;
}

class VersionDesk : public testing::Test {
 protected:
  Result<ModelOfVersions> choose(const AskedVersions& asked) { return model_with(all_, asked, instrument_, readings_); }
  ErrorCode refusal(const AskedVersions& asked) {
    const auto chosen = choose(asked);
    EXPECT_FALSE(chosen);
    return chosen ? ErrorCode::Internal : chosen.error().code;
  }

  const Instrument instrument_ = test::bench_instrument();
  calibration::ScanReadings readings_;
  std::vector<FoundCalibration> all_{zeros(1, 0.1), zeros(2, 0.2, true)};
};

TEST_F(VersionDesk, TakesWhatCountsWhenNothingIsAsked) {
  const auto chosen = choose(std::nullopt);

  ASSERT_TRUE(chosen) << describe(chosen.error());
  EXPECT_EQ(chosen->versions, (std::vector<CalibrationVersion>{2}));
  EXPECT_NEAR(in_degrees(chosen->model.angles.zero[0]), 0.2, 1e-12);
}

TEST_F(VersionDesk, TakesWhatIsAskedForAndNoneIsTheInstrumentAlone) {
  EXPECT_NEAR(in_degrees(choose(these({1}))->model.angles.zero[0]), 0.1, 1e-12);
  const auto none = choose(asked_versions_from("none").value());
  EXPECT_TRUE(none->versions.empty());
  EXPECT_EQ(in_degrees(none->model.angles.zero[0]), 0.0);
}

TEST_F(VersionDesk, RefusesAVersionThatIsNotThereAndTwoOfOneJob) {
  EXPECT_EQ(refusal(these({7})), ErrorCode::NotFound);
  EXPECT_EQ(refusal(these({1, 2})), ErrorCode::InvalidInput);
}

TEST_F(VersionDesk, RefusesAnotherDetectorsBendAndLeavesItOutByItself) {
  all_.push_back(bend(3, "another camera"));
  all_.back().counts = true;

  EXPECT_EQ(refusal(these({3})), ErrorCode::InvalidInput);
  EXPECT_EQ(choose(std::nullopt)->versions, (std::vector<CalibrationVersion>{2}));
}

TEST_F(VersionDesk, RefusesByNameTheStepThatNeedsFramesThatWereNotKept) {
  all_.push_back(bend(3, instrument_.detector.serial));
  calibration::RawFrame frame;
  frame.reduced = calibration::ReducedMean{.n = 5};
  readings_.readings.push_back({.frames = {frame}});

  const auto chosen = choose(these({3}));

  ASSERT_FALSE(chosen);
  EXPECT_EQ(chosen.error().code, ErrorCode::IncompleteData);
  EXPECT_NE(describe(chosen.error()).find("\"linearity\""), std::string::npos) << describe(chosen.error());
  EXPECT_NE(describe(chosen.error()).find("not kept"), std::string::npos);
  EXPECT_TRUE(choose(these({2}))) << "zeros need no frames";
}

TEST_F(VersionDesk, RefusesARunOfACheckStandard) {
  all_.push_back({.version = 4, .job = "check-standard", .inputs_json = "{}"});

  EXPECT_EQ(refusal(these({4})), ErrorCode::InvalidInput);
}

TEST(AskedVersionsText, IsNumbersOrNoneOrNothing) {
  EXPECT_FALSE(asked_versions_from("").value());
  EXPECT_TRUE(asked_versions_from("none").value()->empty());
  EXPECT_EQ(*asked_versions_from("3, 15").value(), (std::vector<CalibrationVersion>{3, 15}));
  for (const char* wrong : {"three", "3x", "-1", "0"}) {
    const auto asked = asked_versions_from(wrong);
    ASSERT_FALSE(asked) << wrong;
    EXPECT_EQ(asked.error().code, ErrorCode::InvalidInput);
  }
}

}  // namespace
}  // namespace gonio::daemon
