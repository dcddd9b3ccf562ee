#include "protocol/api/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gonio::api {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;
using namespace gonio::literals;

constexpr std::string_view kWheat = R"([scan]
name = "wheat, principal plane"
sample = "wheat-07"
[geometry]
theta_i_deg = [0, 30, 60]
theta_r_deg = {from = 0, to = 75, step = 5}
phi_r_deg   = {from = 0, to = 345, step = 15}
wavelength_nm = [568]
[reading]
target_snr = 500
max_time_s = 4
[reference]
standard = "SRT-99-020"
mode = "same-geometry"
block_s = 900
[visits]
dark_s = 300
[order]
strategy = "random"
seed = 7
[on_error]
item = "retry 3, then hold"
[on_restart]
policy = "hold"
)";

std::string with(std::string_view old_text, std::string_view new_text) {
  std::string text(kWheat);
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}

Error error_of(const std::string& text) {
  const Result<Plan> plan = parse_plan(text, "wheat.toml");
  EXPECT_FALSE(plan.has_value()) << text;
  return plan ? Error{} : plan.error();
}

TEST(Plan, IsReadWhole) {
  const Result<Plan> plan = parse_plan(kWheat, "wheat.toml");

  ASSERT_TRUE(plan.has_value()) << describe(plan.error());
  EXPECT_EQ(plan->name, "wheat, principal plane");
  EXPECT_EQ(plan->sample, "wheat-07");
  EXPECT_TRUE(plan->isotropic);
  EXPECT_EQ(plan->theta_i, (std::vector<Angle>{0_deg, 30_deg, 60_deg}));
  EXPECT_EQ(plan->phi_i, std::vector<Angle>{0_deg});
  EXPECT_EQ(plan->theta_r.size(), 16U);
  EXPECT_EQ(plan->phi_r.size(), 24U);
  EXPECT_EQ(plan->phi_r.back(), 345_deg);
  EXPECT_EQ(plan->wavelengths, std::vector<Wavelength>{568_nm});
  EXPECT_EQ(plan->target_snr, 500.0);
  EXPECT_EQ(plan->max_time, std::chrono::seconds(4));
  EXPECT_EQ(plan->reference_standard, "SRT-99-020");
  EXPECT_EQ(plan->block, std::chrono::seconds(900));
  EXPECT_EQ(plan->dark_every, std::chrono::seconds(300));
  EXPECT_EQ(plan->order, OrderStrategy::Random);
  EXPECT_EQ(plan->order_seed, 7U);
  EXPECT_EQ(plan->item_retries, 3);
  EXPECT_EQ(plan->on_item_error, OnItemError::Hold);
  EXPECT_EQ(plan->on_restart, OnRestart::Hold);
}

TEST(Plan, VisitsOfStandardAndSampleAreMadeOnlyWhereItAsksForThem) {
  const Result<Plan> without = parse_plan(kWheat, "wheat.toml");
  const Result<Plan> with_them = parse_plan(
      with("dark_s = 300", "dark_s = 300\nreference_s = 600\ncheck_s = 900\ndrift_limit = 0.01\ndrift_rounds = 3"),
      "p");

  ASSERT_TRUE(without.has_value()) << describe(without.error());
  ASSERT_TRUE(with_them.has_value()) << describe(with_them.error());
  EXPECT_EQ(without->reference_every, Duration{});
  EXPECT_EQ(without->check_every, Duration{});
  EXPECT_EQ(with_them->reference_every, std::chrono::seconds(600));
  EXPECT_EQ(with_them->check_every, std::chrono::seconds(900));
  EXPECT_EQ(with_them->drift_limit, 0.01);
  EXPECT_EQ(with_them->drift_rounds, 3);
  EXPECT_EQ(error_of(with("dark_s = 300", "drift_limit = 0")).code, ErrorCode::InvalidInput);
}

TEST(Plan, HasAnAnchorAndVisitsOfItInItsModeOnly) {
  const std::string mode = "mode = \"same-geometry\"";
  const Result<Plan> same = parse_plan(kWheat, "p");
  const Result<Plan> plain = parse_plan(with(mode, "mode = \"anchor\""), "p");
  const Result<Plan> named =
      parse_plan(with(mode, "mode = \"anchor\"\nanchor = {theta_i_deg = 8, theta_r_deg = 30, phi_r_deg = 90}"), "p");
  const Result<Plan> absolute = parse_plan(with(mode, "mode = \"absolute\""), "p");

  ASSERT_TRUE(same && plain && named && absolute);
  EXPECT_EQ(same->reference_mode, ReferenceMode::SameGeometry);
  EXPECT_EQ(plain->reference_mode, ReferenceMode::Anchor);
  EXPECT_EQ(plain->anchor.theta_i, 0_deg);
  EXPECT_EQ(plain->anchor.theta_r, 45_deg);
  EXPECT_EQ(plain->reference_every, plain->block) << "without visits there is no BRDF";
  EXPECT_EQ(named->anchor.theta_i, 8_deg);
  EXPECT_EQ(named->anchor.phi_r, 90_deg);
  EXPECT_EQ(absolute->reference_mode, ReferenceMode::Absolute);
  EXPECT_EQ(absolute->reference_every, Duration{});
  EXPECT_EQ(error_of(with(mode, mode + "\nanchor = {theta_i_deg = 0, theta_r_deg = 45}")).where->field,
            "reference.anchor");
}

TEST(Plan, StepsReachTheirLastValueWithoutCreep) {
  const Result<Plan> plan = parse_plan(with("{from = 0, to = 75, step = 5}", "{from = 0, to = 1, step = 0.1}"), "p");

  ASSERT_TRUE(plan.has_value()) << describe(plan.error());
  ASSERT_EQ(plan->theta_r.size(), 11U);
  EXPECT_EQ(plan->theta_r[3], 0.3_deg);
  EXPECT_EQ(plan->theta_r[7], 0.7_deg);
  EXPECT_EQ(plan->theta_r.back(), 1_deg);
}

TEST(Plan, StepsThatMissTheirEndAreRefusedAndSayWhereTheyEnd) {
  const Error error = error_of(with("{from = 0, to = 75, step = 5}", "{from = 0, to = 75, step = 10}"));

  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  EXPECT_EQ(error.where, (InputLocation{"wheat.toml", 6, "geometry.theta_r_deg.step"}));
  EXPECT_THAT(error.limit, HasSubstr("70 deg"));
}

TEST(Plan, OneStepOfZeroLengthIsOneValue) {
  const Result<Plan> plan = parse_plan(with("{from = 0, to = 75, step = 5}", "{from = 10, to = 10, step = 5}"), "p");

  ASSERT_TRUE(plan.has_value()) << describe(plan.error());
  EXPECT_EQ(plan->theta_r, std::vector<Angle>{10_deg});
}

TEST(Plan, AMisspeltKeyIsNamedWithItsLineAndTheNearestName) {
  const Error error = error_of(with("theta_i_deg", "theta_deg"));

  EXPECT_EQ(error.code, ErrorCode::MissingKey);
  EXPECT_EQ(error.where->field, "geometry.theta_i_deg");

  const Error extra = error_of(with("target_snr = 500", "target_snr = 500\nmax_tim_s = 3"));
  EXPECT_EQ(extra.code, ErrorCode::UnknownKey);
  EXPECT_EQ(extra.where, (InputLocation{"wheat.toml", 11, "reading.max_tim_s"}));
  EXPECT_THAT(extra.limit, HasSubstr("max_time_s"));
}

TEST(Plan, ExposuresAreChosenUnlessOneOrSeveralAreStated) {
  const auto chosen = parse_plan(kWheat, "wheat.toml");
  const auto fixed = parse_plan(with("max_time_s = 4", "max_time_s = 4\nexposure_s = 0.016"), "wheat.toml");
  const auto bracket =
      parse_plan(with("max_time_s = 4", "max_time_s = 4\nexposure_s = [0.5, 0.002, 0.03]"), "wheat.toml");

  ASSERT_TRUE(chosen && fixed && bracket);
  EXPECT_TRUE(chosen->exposures.empty());
  EXPECT_EQ(fixed->exposures, std::vector<Duration>{std::chrono::milliseconds(16)});
  EXPECT_EQ(bracket->exposures, (std::vector<Duration>{std::chrono::milliseconds(2), std::chrono::milliseconds(30),
                                                       std::chrono::milliseconds(500)}));
}

TEST(Plan, StatedExposuresThatDoNotFitIntoTheTimeOfAReadingNameTheirSum) {
  const Error error = error_of(with("max_time_s = 4", "max_time_s = 4\nexposure_s = [2.5, 1.75]"));

  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  EXPECT_EQ(error.where->field, "reading.exposure_s");
  EXPECT_EQ(error.seen, "4.25 s in all");
  EXPECT_EQ(error.limit, "at most max_time_s = 4 s");
}

TEST(Plan, AnExposureThatStandsTwiceIsRefused) {
  const Error error = error_of(with("max_time_s = 4", "max_time_s = 4\nexposure_s = [0.5, 0.5]"));

  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  EXPECT_THAT(error.seen, HasSubstr("twice"));
}

TEST(Plan, AnAngleInAnotherUnitIsAnUnknownKey) {
  const Error error = error_of(with("theta_i_deg = [0, 30, 60]", "theta_i_deg = [0]\ntheta_i_rad = [0, 0.5]"));

  EXPECT_EQ(error.code, ErrorCode::UnknownKey);
  EXPECT_THAT(error.limit, HasSubstr("theta_i_deg"));
}

TEST(Plan, AnAngleBeyondTheHorizonNamesValueUnitAndLimit) {
  const Error error = error_of(with("[0, 30, 60]", "[0, 30, 95]"));

  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  EXPECT_EQ(error.where, (InputLocation{"wheat.toml", 5, "geometry.theta_i_deg"}));
  EXPECT_THAT(error.seen, HasSubstr("95 deg"));
  EXPECT_THAT(error.limit, HasSubstr("90 deg"));
}

TEST(Plan, AValueThatStandsTwiceIsRefused) {
  EXPECT_THAT(error_of(with("[0, 30, 60]", "[0, 30, 30]")).seen, HasSubstr("30 deg stands here twice"));
}

TEST(Plan, AnEmptyListIsRefused) {
  EXPECT_EQ(error_of(with("[0, 30, 60]", "[]")).where->field, "geometry.theta_i_deg");
}

TEST(Plan, AMissingWavelengthIsRefused) {
  const Error error = error_of(with("wavelength_nm = [568]", ""));

  EXPECT_EQ(error.code, ErrorCode::MissingKey);
  EXPECT_EQ(error.where->field, "geometry.wavelength_nm");
}

TEST(Plan, TooManyPointsAreRefusedBeforeTheyAreMade) {
  const Error error = error_of(
      with("phi_r_deg   = {from = 0, to = 345, step = 15}", "phi_r_deg = {from = -360, to = 360, step = 0.001}"));

  EXPECT_THAT(error.limit, HasSubstr("at most"));
}

TEST(Plan, APolicyThatCannotBeReadShowsTheGrammar) {
  for (const std::string_view policy : {"retry, then skip", "retry 2 then skip", "retry 99, then skip", "panic"}) {
    const Error error = error_of(with("retry 3, then hold", policy));
    EXPECT_EQ(error.where->field, "on_error.item");
    EXPECT_THAT(error.limit, HasSubstr("retry N, then skip"));
  }
}

TEST(Plan, APolicyWithoutRetriesIsOneWord) {
  const Result<Plan> plan = parse_plan(with("retry 3, then hold", "fail"), "p");

  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->item_retries, 0);
  EXPECT_EQ(plan->on_item_error, OnItemError::Fail);
}

TEST(Plan, OnlyNameSampleGeometryAndReferenceAreNeeded) {
  const Result<Plan> plan = parse_plan(
      "[scan]\nname = \"n\"\nsample = \"s\"\n[geometry]\ntheta_i_deg = [10]\ntheta_r_deg = [20]\nphi_r_deg = [0]\n"
      "wavelength_nm = [568]\n[reference]\nstandard = \"R\"\n",
      "p");

  ASSERT_TRUE(plan.has_value()) << describe(plan.error());
  EXPECT_EQ(plan->item_retries, 2);
  EXPECT_EQ(plan->max_time, std::chrono::seconds(4));
  EXPECT_EQ(plan->order, OrderStrategy::Fastest);
  EXPECT_EQ(plan->on_restart, OnRestart::Resume);
}

TEST(Plan, TextThatIsNotTomlNamesFileAndLine) {
  const Error error = error_of("[scan]\nname = \n");

  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  EXPECT_EQ(error.where->file, "wheat.toml");
  EXPECT_EQ(error.where->line, 2);
}

}  // namespace
}  // namespace gonio::api
