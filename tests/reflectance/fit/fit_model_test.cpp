#include "reflectance/fit/fit_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reflectance/surfaces.h"

namespace gonio::fit::test {
namespace {

using ::testing::HasSubstr;

std::vector<double> starts_of(const FitModel& model) {
  std::vector<double> x;
  for (const FitParameter& p : model.parameters()) x.push_back(p.start);
  return x;
}

TEST(FitModel, NamesTheNumbersOfASumByTheirTerm) {
  const FitModel model = FitModel::make("lambertian + ggx").value();

  std::vector<std::string> names;
  for (const FitParameter& p : model.parameters()) names.push_back(p.name);

  EXPECT_THAT(names, ::testing::ElementsAre("1.weight", "1.rho", "2.weight", "2.roughness", "2.refractive_index"));
  EXPECT_EQ(model.free_count(), 3U);  // rho, the gloss's weight and roughness
}

TEST(FitModel, IsTheSumOfItsTerms) {
  const FitModel model = FitModel::make("lambertian+ggx").value();
  std::vector<double> x = starts_of(model);
  x[2] = 0.3;
  std::vector<double> slopes(x.size());
  const auto i = reflectance::Direction::from_angles(degrees(40.0), {});
  const auto r = reflectance::Direction::from_angles(degrees(45.0), degrees(170.0));

  const double value = model.value(pair_terms(i, r), x, slopes);

  EXPECT_NEAR(value, model.surface(x).value().eval(i, r).si(), 1e-12 * value);
  EXPECT_NEAR(slopes[2] * 0.3 + slopes[1] * 0.5, value, 1e-12 * value);  // linear in weight and rho
}

TEST(FitModel, HasAWordForWhatItCannotBe) {
  EXPECT_THAT(FitModel::make("lambertain").error().limit, HasSubstr("lambertian"));
  EXPECT_THAT(FitModel::make("rpv + ").error().seen, HasSubstr("\"\""));
  EXPECT_THAT(FitModel::make("rpv+rpv+rpv+rpv+rpv").error().seen, HasSubstr("5 terms"));
}

TEST(FitModel, ChangesBoundsStartsAndWhatIsFree) {
  FitModel model = FitModel::make("cox_munk").value();

  EXPECT_TRUE(model.change("refractive_index", {.start = 1.33, .is_fixed = false}));
  EXPECT_EQ(model.free_count(), 2U);
  EXPECT_EQ(model.change("wind", {}).error().code, ErrorCode::UnknownKey);
  EXPECT_THAT(model.change("wind_m_per_s", {.most = 40.0}).error().limit, HasSubstr("within 0 to 30"));
  EXPECT_THAT(model.change("wind_m_per_s", {.start = -1.0}).error().seen, HasSubstr("start -1"));
  EXPECT_FALSE(model.change("wind_m_per_s", {.least = 5.0, .most = 5.0}));
}

}  // namespace
}  // namespace gonio::fit::test
