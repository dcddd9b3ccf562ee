#include "protocol/api/plan_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "protocol/api/plan.h"

namespace gonio::api {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr std::string_view kLadder = R"([scan]
name = "ladder"
sample = "tile"
[calibration]
job = "linearity"
order = 1
[geometry]
theta_i_deg = [0]
theta_r_deg = [30]
phi_r_deg = [90]
wavelength_nm = [568]
repeats = 5
[reading]
max_time_s = 1
exposure_s = [0.001, 0.004, 0.002, 0.008]
[reference]
standard = "SRT"
)";

constexpr std::string_view kMirror = R"([scan]
name = "zeros"
sample = "mirror M1"
[calibration]
job = "arm-zeros"
wavelength_nm = 568
theta_i_deg = [20, 40, 60]
half_width_deg = 0.4
step_deg = 0.1
u_mirror_deg = 0.01
[reference]
standard = "SRT"
)";

constexpr std::string_view kBeam = R"([scan]
name = "beam"
sample = "nothing"
[calibration]
job = "direct-beam"
wavelength_nm = [480, 568]
theta_i_deg = 80
beside_deg = 0.2
repeats = 4
[reference]
standard = "SRT"
)";

constexpr std::string_view kSignature = R"([scan]
name = "signature"
sample = "nothing"
[calibration]
job = "signature"
wavelength_nm = [480, 568]
theta_i_deg = 80
half_width_deg = 2.0
step_deg = 0.25
repeats = 2
[reference]
standard = "SRT"
)";

std::string changed(std::string_view plan, std::string_view from, std::string_view to) {
  std::string text(plan);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}
Error error_of(const std::string& text) {
  const Result<Plan> plan = parse_plan(text, "job.toml");
  EXPECT_FALSE(plan) << text;
  return plan ? Error{} : plan.error();
}

TEST(PlanCalibration, AnOrdinaryPlanNamesNoJob) {
  const auto plan = parse_plan(changed(kLadder, "[calibration]\njob = \"linearity\"\norder = 1\n", ""), "plan.toml");

  ASSERT_TRUE(plan) << describe(plan.error());
  EXPECT_FALSE(plan->calibration);
  EXPECT_EQ(plan->exposures.size(), 4U);
}

TEST(PlanCalibration, ALaddersExposuresClimbAndComeDownAgain) {
  const auto plan = parse_plan(kLadder, "job.toml");

  ASSERT_TRUE(plan) << describe(plan.error());
  EXPECT_EQ(plan->calibration->job, CalibrationJob::Linearity);
  EXPECT_EQ(plan->calibration->order, 1);
  EXPECT_EQ(plan->exposures,
            (std::vector<Duration>{milliseconds(1), milliseconds(2), milliseconds(4), milliseconds(8), milliseconds(8),
                                   milliseconds(4), milliseconds(2), milliseconds(1)}));
}

TEST(PlanCalibration, ALadderNeedsEnoughStepsAndTheTimeForTwiceOfThem) {
  EXPECT_THAT(describe(error_of(changed(kLadder, "order = 1", "order = 2"))), HasSubstr("5 at least"));
  EXPECT_EQ(error_of(changed(kLadder, "exposure_s = [0.001, 0.004, 0.002, 0.008]\n", "")).code, ErrorCode::MissingKey);
  EXPECT_THAT(describe(error_of(changed(kLadder, "max_time_s = 1", "max_time_s = 0.02"))),
              HasSubstr("up and down the ladder"));
}

TEST(PlanCalibration, ArmZerosMakesItsOwnCrossings) {
  const auto plan = parse_plan(kMirror, "job.toml");

  ASSERT_TRUE(plan) << describe(plan.error());
  EXPECT_FALSE(plan->isotropic);
  ASSERT_EQ(plan->parts.size(), 7U) << "two at each theta_i, and across the normal";
  const auto& along_theta = std::get<ProductShape>(plan->parts[2].shape);
  EXPECT_EQ(along_theta.theta_r.size(), 9U);
  EXPECT_NEAR(in_degrees(along_theta.theta_r.front()), 39.6, 1e-9);
  EXPECT_NEAR(in_degrees(along_theta.phi_r.front()), 180.0, 1e-9);
  const auto& along_phi = std::get<ProductShape>(plan->parts[3].shape);
  EXPECT_NEAR(in_degrees(along_phi.phi_r.back()), 180.0 + 0.4 / std::sin(in_radians(degrees(40.0))), 1e-8);
  const auto& across = std::get<ProductShape>(plan->parts[6].shape);
  EXPECT_EQ(across.theta_r.size(), 8U) << "outwards from the normal, twice as fine";
  EXPECT_EQ(across.phi_r.size(), 4U);
  EXPECT_EQ(in_degrees(plan->parts[6].theta_i.front()), 0.0);
}

TEST(PlanCalibration, ArmZerosTakesNoGeometryOfItsAuthorsAndThreeAnglesAtLeast) {
  EXPECT_EQ(error_of(changed(kMirror, "[reference]", "[geometry]\ntheta_i_deg = [0]\n[reference]")).code,
            ErrorCode::UnknownKey);
  EXPECT_THAT(describe(error_of(changed(kMirror, "[20, 40, 60]", "[20, 40]"))), HasSubstr("three at least"));
  EXPECT_EQ(error_of(changed(kMirror, "u_mirror_deg = 0.01\n", "")).code, ErrorCode::MissingKey)
      << "nobody knows it but the operator";
}

TEST(PlanCalibration, ADirectBeamIsReadStraightThroughAndOnFourSidesOfItAgainstNoStandard) {
  const auto plan = parse_plan(kBeam, "job.toml");

  ASSERT_TRUE(plan) << describe(plan.error());
  EXPECT_EQ(plan->reference_mode, ReferenceMode::Absolute);
  EXPECT_FALSE(plan->isotropic);
  ASSERT_EQ(plan->parts.size(), 5U);
  std::vector<std::pair<double, double>> places;
  for (const PlanPart& part : plan->parts) {
    EXPECT_NEAR(in_degrees(part.theta_i.at(0)), 80.0, 1e-12);
    EXPECT_EQ(part.wavelengths.size(), 2U);
    EXPECT_EQ(part.repeats, 4);
    const auto& place = std::get<ProductShape>(part.shape);
    places.emplace_back(in_degrees(place.theta_r.at(0)), in_degrees(place.phi_r.at(0)));
  }
  const double along_phi = 0.2 / std::sin(in_radians(degrees(100.0)));
  EXPECT_NEAR(places[0].first, 100.0, 1e-9);
  EXPECT_NEAR(places[0].second, 180.0, 1e-9);
  EXPECT_NEAR(places[1].first, 99.8, 1e-9);
  EXPECT_NEAR(places[2].second, 180.0 - along_phi, 1e-8);
  EXPECT_NEAR(places[3].first, 100.2, 1e-9);
  EXPECT_NEAR(places[4].second, 180.0 + along_phi, 1e-8);
}

TEST(PlanCalibration, AFlatFieldIsReadOnTheStandardAtStatedExposures) {
  const std::string flat = changed(kLadder, "job = \"linearity\"\norder = 1", "job = \"flat-field\"\nframes = 64");
  const auto plan = parse_plan(flat, "job.toml");

  ASSERT_TRUE(plan) << describe(plan.error());
  EXPECT_EQ(plan->calibration->job, CalibrationJob::FlatField);
  EXPECT_EQ(plan->calibration->frames, 64);
  EXPECT_EQ(plan->exposures.size(), 4U) << "no ladder: it does not come down again";
  EXPECT_EQ(error_of(changed(flat, "exposure_s = [0.001, 0.004, 0.002, 0.008]\n", "")).where->field,
            "reading.exposure_s");
  EXPECT_EQ(error_of(flat + "mode = \"anchor\"\n").where->field, "reference.mode");
  EXPECT_EQ(error_of(changed(flat, "frames = 64", "frames = 1")).where->field, "calibration.frames");
}

TEST(PlanCalibration, ADarkMapChoosesItsExposuresAsAnyScan) {
  const auto plan = parse_plan(changed(changed(kLadder, "job = \"linearity\"\norder = 1", "job = \"dark-map\""),
                                       "exposure_s = [0.001, 0.004, 0.002, 0.008]\n", ""),
                               "job.toml");

  ASSERT_TRUE(plan) << describe(plan.error());
  EXPECT_EQ(plan->calibration->job, CalibrationJob::DarkMap);
  EXPECT_GE(plan->calibration->frames, 2);
}

TEST(PlanCalibration, ADirectBeamTakesNoTargetBesideIt) {
  const std::string beam(kBeam);

  EXPECT_EQ(error_of(beam + "mode = \"same-geometry\"\n").where->field, "reference.mode");
  EXPECT_EQ(error_of(beam + "[visits]\nreference_s = 60\n").where->field, "visits.reference_s");
  EXPECT_EQ(error_of(beam + "[visits]\ncheck_s = 60\n").where->field, "visits.check_s");
  EXPECT_TRUE(parse_plan(beam + "mode = \"absolute\"\n[visits]\ndark_s = 60\n", "job.toml"));
}

TEST(PlanCalibration, ASignatureCrossesTheBeamAlongThetaAndAlongPhiAgainstNoStandard) {
  const auto plan = parse_plan(kSignature, "job.toml");

  ASSERT_TRUE(plan) << describe(plan.error());
  EXPECT_EQ(plan->calibration->job, CalibrationJob::Signature);
  EXPECT_EQ(plan->reference_mode, ReferenceMode::Absolute);
  EXPECT_FALSE(plan->isotropic);
  ASSERT_EQ(plan->parts.size(), 2U);
  for (const PlanPart& part : plan->parts) {
    EXPECT_NEAR(in_degrees(part.theta_i.at(0)), 80.0, 1e-12);
    EXPECT_EQ(part.wavelengths.size(), 2U);
    EXPECT_EQ(part.repeats, 2);
  }
  const auto& in_plane = std::get<ProductShape>(plan->parts[0].shape);
  ASSERT_EQ(in_plane.theta_r.size(), 17U);
  EXPECT_NEAR(in_degrees(in_plane.theta_r.front()), 98.0, 1e-9);
  EXPECT_NEAR(in_degrees(in_plane.theta_r.back()), 102.0, 1e-9);
  ASSERT_EQ(in_plane.phi_r.size(), 1U);
  EXPECT_NEAR(in_degrees(in_plane.phi_r[0]), 180.0, 1e-9);
  const auto& across = std::get<ProductShape>(plan->parts[1].shape);
  ASSERT_EQ(across.phi_r.size(), 16U) << "the middle is read with the other crossing";
  EXPECT_NEAR(in_degrees(across.phi_r.front()), 180.0 - 2.0 / std::sin(in_radians(degrees(100.0))), 1e-8);
  EXPECT_NEAR(in_degrees(across.theta_r.at(0)), 100.0, 1e-9);
}

TEST(PlanCalibration, ASignatureSaysWhichFieldIsWrong) {
  const auto field_of = [](std::string_view from, std::string_view to) {
    const Error error = error_of(changed(kSignature, from, to));
    EXPECT_EQ(error.where->file, "job.toml");
    EXPECT_GT(error.where->line, 0) << describe(error);
    return error.where->field;
  };

  EXPECT_EQ(field_of("[480, 568]", "[48]"), "calibration.wavelength_nm");
  EXPECT_EQ(field_of("theta_i_deg = 80", "theta_i_deg = 30"), "calibration.theta_i_deg");
  EXPECT_EQ(field_of("half_width_deg = 2.0\n", ""), "calibration.half_width_deg");
  EXPECT_EQ(field_of("half_width_deg = 2.0", "half_width_deg = 40"), "calibration.half_width_deg");
  EXPECT_EQ(field_of("half_width_deg = 2.0", "half_width_deg = 10"), "calibration.half_width_deg") << "theta_r = 90";
  EXPECT_EQ(field_of("step_deg = 0.25\n", ""), "calibration.step_deg");
  EXPECT_EQ(field_of("step_deg = 0.25", "step_deg = 0.6"), "calibration.step_deg");
  EXPECT_EQ(field_of("repeats = 2", "repeats = 0"), "calibration.repeats");
  EXPECT_EQ(field_of("repeats = 2", "beside_deg = 0.1"), "calibration.beside_deg");
}

TEST(PlanCalibration, ASignatureTakesNoTargetBesideIt) {
  const std::string signature(kSignature);

  EXPECT_EQ(error_of(signature + "mode = \"anchor\"\n").where->field, "reference.mode");
  EXPECT_EQ(error_of(signature + "[visits]\nreference_s = 60\n").where->field, "visits.reference_s");
  EXPECT_TRUE(parse_plan(signature + "[visits]\ndark_s = 60\n", "job.toml"));
}

TEST(PlanCalibration, NamesTheJobsThatThereAre) {
  EXPECT_THAT(describe(error_of(changed(kLadder, "\"linearity\"", "\"linearty\""))), HasSubstr("check-standard"));
}

}  // namespace
}  // namespace gonio::api
