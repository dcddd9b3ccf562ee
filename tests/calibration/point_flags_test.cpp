// What a reader of a value must know beside U, and that each of it has its word.
#include "calibration/point_flags.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibration/calibrate.h"
#include "tests/calibration/reference_text.h"
#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};

ReferenceStandard standard() {
  auto parsed = ReferenceStandard::parse(ReferenceText{}.text(), "white.toml");
  EXPECT_TRUE(parsed) << describe(parsed.error());
  return std::move(parsed).value();
}

InstrumentModel noisy() {
  return {.detector = {.electrons_per_dn = 2.0, .read_noise_dn = 3.0}};
}

CalibratedScan calibrated(const ScanReadings& scan, const InstrumentModel& instrument = noisy()) {
  auto result = calibrate(scan, instrument, standard(), kToday);
  EXPECT_TRUE(result) << describe(result.error());
  return std::move(result).value();
}

/// One point, half as bright as the reference.
ScanBuilder one_point(double sample_dn = 1000.0, double reference_dn = 2000.0, double theta_r_deg = 45.0) {
  ScanBuilder builder({0.01, 0.02});
  const auto point = builder.add_point(directions(0.0, theta_r_deg, 0.0));
  builder.add_dark(0.0);
  builder.add_item(Target::Sample, point, 1.0, 0.02, sample_dn);
  builder.add_item(Target::Reference, point, 2.0, 0.02, reference_dn);
  builder.add_dark(10.0);
  return builder;
}

std::string words(const CalibratedScan& scan) {
  return flag_words(scan.points.at(0).flags);
}

bool says(const CalibratedScan& scan, std::string_view word) {
  return words(scan).find(word) != std::string::npos;
}

TEST(PointFlags, AnOrdinaryPointHasNoneOfThem) {
  const std::string said = words(calibrated(one_point().scan()));

  for (const char* word : {"near-zero", "saturated", "blocked", "reference-extrapolated", "uncertain-divisor",
                           "few-repeats", "dark-extrapolated", "borrowed-reference", "drifted", "mixed"}) {
    EXPECT_EQ(said.find(word), std::string::npos) << word;
  }
}

TEST(PointFlags, AValueWithinItsUOfZeroKeepsItsSignAndSaysNearZero) {
  const CalibratedScan scan = calibrated(one_point(-0.2).scan());

  EXPECT_LT(scan.points.at(0).value.si(), 0.0);
  EXPECT_TRUE(says(scan, "near-zero"));
}

TEST(PointFlags, ANegativeValueClearOfZeroIsKeptAndNotFlagged) {
  const CalibratedScan scan = calibrated(one_point(-500.0).scan());

  EXPECT_LT(scan.points.at(0).value.si(), 0.0);
  EXPECT_FALSE(says(scan, "near-zero"));
}

TEST(PointFlags, ASaturatedExposureIsLeftOutWholeAndTheShorterOneSaysSaturated) {
  ScanBuilder builder = one_point();
  RawReading& sample = builder.scan().readings[1];
  RawFrame longer = sample.frames.front();
  sample.frames.front().exposure_s = 0.01;
  sample.frames.front().region.mean = ScanBuilder::kDarkDn + 500.0;
  sample.frames.push_back(longer);  // of two frames that long one is clipped: the other counts no more
  sample.frames.push_back(longer);
  sample.frames.back().region.saturated = 1;
  sample.frames[1].region.mean += 50.0;

  const CalibratedScan scan = calibrated(builder.scan());

  ASSERT_EQ(scan.points.size(), 1U);
  EXPECT_NEAR(scan.points[0].value.si(), calibrated(one_point().scan()).points[0].value.si(), 1e-12);
  EXPECT_TRUE(says(scan, "saturated"));
}

TEST(PointFlags, AReadingWithoutAShorterExposureIsRefusedAsSaturated) {
  ScanBuilder builder = one_point();
  builder.scan().readings[1].frames[0].region.saturated = 3;

  const CalibratedScan scan = calibrated(builder.scan());

  ASSERT_EQ(scan.refused.size(), 1U);
  EXPECT_EQ(scan.refused[0].reason.code, ErrorCode::Saturated);
  EXPECT_NE(describe(scan.refused[0].reason).find("3 saturated pixels"), std::string::npos);
}

TEST(PointFlags, AReadingWhoseSaturatedExposuresWereLeftOutBeforeSaysSo) {
  ScanBuilder builder = one_point();
  builder.scan().readings[1].has_saturated = true;

  EXPECT_TRUE(says(calibrated(builder.scan()), "saturated"));
}

TEST(PointFlags, NoiseFromFewFramesSaysFewRepeats) {
  InstrumentModel model = noisy();
  model.detector.noise = NoiseSource::RepeatedFrames;
  ScanBuilder builder = one_point();
  RawReading& sample = builder.scan().readings[1];
  for (const double dn : {30.0, -20.0}) {
    sample.frames.push_back(sample.frames.front());
    sample.frames.back().region.mean += dn;
  }

  const CalibratedScan scan = calibrated(builder.scan(), model);

  EXPECT_TRUE(says(scan, "few-repeats"));
  EXPECT_GT(scan.points.at(0).budget.k, 2.2) << "Student's";
}

TEST(PointFlags, AGeometryJustBeyondTheShapeTableSaysSoAndOneFurtherOutIsRefused) {
  const double edge = in_degrees(standard().last_theta_r());

  EXPECT_FALSE(says(calibrated(one_point(1000.0, 2000.0, edge).scan()), "reference-extrapolated"));
  EXPECT_TRUE(says(calibrated(one_point(1000.0, 2000.0, edge + 0.05).scan()), "reference-extrapolated"));
  const CalibratedScan beyond = calibrated(one_point(1000.0, 2000.0, edge + 0.2).scan());
  ASSERT_EQ(beyond.refused.size(), 1U);
  EXPECT_EQ(beyond.refused[0].reason.code, ErrorCode::ReferenceOutOfReach);
  EXPECT_NE(describe(beyond.refused[0].reason).find("the shape table ends at"), std::string::npos);
}

TEST(PointFlags, APointInTheOtherArmsShadowThatWasReadAllTheSameSaysBlocked) {
  ScanBuilder builder = one_point();
  builder.scan().points[0].is_blocked = true;

  EXPECT_TRUE(says(calibrated(builder.scan()), "blocked"));
}

TEST(PointFlags, ADimReferenceSaysThatItsDivisorIsUncertain) {
  EXPECT_TRUE(says(calibrated(one_point(3.0, 6.0).scan()), "uncertain-divisor"));
}

/// One point by the anchor, visited before and after it.
ScanBuilder anchored(double visit_dn) {
  ScanBuilder builder({0.02});
  builder.scan().reference_mode = ReferenceMode::Anchor;
  const auto point = builder.add_point(directions(0.0, 45.0, 0.0));
  builder.add_dark(0.0);
  for (const double at_s : {1.0, 2.0, 3.0}) {
    RawReading& reading =
        builder.add_item(at_s == 2.0 ? Target::Sample : Target::Reference, point, at_s, 0.02, visit_dn);
    if (at_s == 2.0) continue;
    reading.visited_point = reading.point_index;
    reading.point_index.reset();
  }
  builder.add_dark(10.0);
  return builder;
}

TEST(PointFlags, TheNoiseOfTheAnchorsVisitsCountsForTheDivisor) {
  EXPECT_FALSE(says(calibrated(anchored(1000.0).scan()), "uncertain-divisor"));
  EXPECT_TRUE(says(calibrated(anchored(5.0).scan()), "uncertain-divisor"));
}

// S - D over V - D', all in one dark: with S as bright as V its error cancels but for the visits' own weights.
TEST(Anchor, ADarkThatSampleAndVisitsRestOnCancelsAndIsCountedOnce) {
  InstrumentModel model = noisy();
  model.detector.electrons_per_dn = 1e9;
  const CalibratedScan scan = calibrated(anchored(100.0).scan(), model);

  ASSERT_EQ(scan.points.size(), 1U);
  const double f = scan.points[0].value.si();
  const double u_dark = 3.0 / std::sqrt(double{ScanBuilder::kPixels});  // of one frame's mean
  const double visits = std::hypot(0.5, 0.5) * u_dark / 100.0;          // each its own noise, half its weight
  double darks2 = 0.0;
  double visits2 = 0.0;
  for (const BudgetTerm& term : scan.points[0].budget.shared) {
    const std::string& name = scan.components[term.component].name;
    if (name.starts_with("dark visit")) darks2 += term.per_sd.si() * term.per_sd.si();
    if (name.starts_with("reference visit")) visits2 += term.per_sd.si() * term.per_sd.si();
  }
  EXPECT_NEAR(std::sqrt(visits2), f * visits, 1e-3 * f * visits);
  EXPECT_NEAR(std::sqrt(darks2), 0.0, 1e-9 * f);
}

TEST(PointFlags, EachHasItsWordOnce) {
  std::uint32_t all = 0;
  for (const FlagWord& word : all_flag_words()) {
    EXPECT_EQ(flag_name(word.flag), word.name);
    EXPECT_FALSE(word.meaning.empty()) << word.name;
    all |= static_cast<std::uint32_t>(word.flag);
  }
  EXPECT_EQ(flag_words(all).empty(), false);
  EXPECT_EQ(all, (1U << all_flag_words().size()) - 1U);
}

}  // namespace
}  // namespace gonio::calibration
