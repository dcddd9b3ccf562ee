// The second promise: of the stated 95.45 % intervals, 95.45 % hold the truth, on every scene, with every shared error
// drawn anew for each repetition. The truth comes from the simulator alone. The short form: `scripts/coverage` is the
// long one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "tests/coverage/campaign.h"

namespace gonio::coverage {

// Found by gtest beside the types.
void PrintTo(const CoverageScene& c, std::ostream* out) {
  *out << c.name;
}

void PrintTo(const LeftOutCase& c, std::ostream* out) {
  *out << correction_name(c.correction);
}

namespace {

constexpr int kRepetitions = 300;
constexpr int kThreads = 2;

CoverageFigures measured(const CoverageScene& scene, bool without_certificate,
                         std::optional<Correction> left_out = std::nullopt) {
  const auto prepared = prepare(scene, without_certificate);
  if (!prepared) {
    ADD_FAILURE() << describe(prepared.error());
    return {};
  }
  const auto outcomes =
      run_campaign(*prepared, {.repetitions = kRepetitions, .threads = kThreads, .left_out = left_out});
  if (!outcomes) {
    ADD_FAILURE() << describe(outcomes.error());
    return {};
  }
  const CoverageFigures f = figures_of(*outcomes);
  std::printf(
      "coverage %s%s, seeds %llu+%d, %zu points: %.2f %% held (s.e. %.2f %%), rho_dh %.2f %%, RMS z %.3f, rho_dh %.3f; "
      "width %.3f, rho_dh %.3f; worst point %.1f %%; median U/f %.2f %%; refused %.2f %%\n",
      scene.name.c_str(), without_certificate ? " without certificate" : "",
      static_cast<unsigned long long>(scene.first_seed), f.repetitions, prepared->points.size(), 100.0 * f.held.value,
      100.0 * f.held.standard_error, 100.0 * f.rho_held.value, f.rms_z, f.rho_rms_z, f.width, f.rho_width,
      100.0 * f.least_point, 100.0 * f.relative_expanded, 100.0 * f.refused);
  return f;
}

std::string lines_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

class Coverage : public testing::TestWithParam<CoverageScene> {};

TEST_P(Coverage, HoldsTheTruthAsOftenAsStatedAndNotByWideIntervals) {
  const CoverageScene& scene = GetParam();

  const CoverageFigures figures = measured(scene, false);

  const std::vector<std::string> found = failures(figures, Claim::for_few(figures.repetitions));
  EXPECT_TRUE(found.empty()) << lines_of(found);
}

std::string name_of(const testing::TestParamInfo<CoverageScene>& test) {
  return test.param.name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Coverage, testing::ValuesIn(coverage_scenes()), name_of);

std::vector<CoverageScene> scenes_named(const std::vector<std::string>& names) {
  std::vector<CoverageScene> found;
  for (CoverageScene& scene : coverage_scenes()) {
    if (std::ranges::find(names, scene.name) != names.end()) found.push_back(std::move(scene));
  }
  return found;
}

// What dominates most budgets covers up for the rest.
class CoverageWithoutCertificate : public testing::TestWithParam<CoverageScene> {};

TEST_P(CoverageWithoutCertificate, HoldsTheTruthAsWell) {
  const CoverageFigures figures = measured(GetParam(), true);

  const std::vector<std::string> found = failures(figures, Claim::for_few(figures.repetitions));
  EXPECT_TRUE(found.empty()) << lines_of(found);
}

INSTANTIATE_TEST_SUITE_P(Scenes, CoverageWithoutCertificate,
                         testing::ValuesIn(scenes_named({"lambertian", "wheat", "glint", "shape", "drifted_lamp"})),
                         name_of);

class CoverageWithoutACorrection : public testing::TestWithParam<LeftOutCase> {};

TEST_P(CoverageWithoutACorrection, IsFoundOut) {
  const auto scenes = scenes_named({GetParam().scene});
  ASSERT_EQ(scenes.size(), 1U);

  const CoverageFigures figures = measured(scenes.front(), false, GetParam().correction);

  const std::vector<std::string> found = failures(figures, Claim::for_few(figures.repetitions));
  EXPECT_FALSE(found.empty()) << "without " << correction_name(GetParam().correction);
  std::printf("without %s:%s\n", correction_name(GetParam().correction), lines_of(found).c_str());
}

INSTANTIATE_TEST_SUITE_P(Each, CoverageWithoutACorrection, testing::ValuesIn(left_out_cases()),
                         [](const testing::TestParamInfo<LeftOutCase>& test) {
                           std::string name = correction_name(test.param.correction);
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

}  // namespace
}  // namespace gonio::coverage
