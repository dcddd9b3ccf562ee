#include "reflectance/surface/make_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "reflectance/surface/rpv.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;
using ::testing::HasSubstr;

const Parameters kWheat{{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}};

// A value within each range, as close to 0.5 as the range allows.
Parameters some_parameters(const ModelSpec& spec) {
  Parameters parameters;
  for (const ParameterSpec& p : spec.parameters) {
    parameters.push_back({std::string(p.name), std::clamp(0.5, p.least, p.most)});
  }
  return parameters;
}

TEST(MakeSurface, GivesTheModelByItsNameWithItsParametersInAnyOrder) {
  const Parameters shuffled{{"g", -0.114}, {"rho0", 0.133}, {"k", 0.851}};

  const Result<Surface> surface = make_surface("rpv", shuffled);

  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->model(), "rpv");
  EXPECT_EQ(surface->parameters(), kWheat);
  ASSERT_NE(surface->as<Rpv>(), nullptr);
}

TEST(MakeSurface, MakesEveryModelOfItsTable) {
  std::set<std::string_view> names;
  for (const ModelSpec& spec : surface_models()) {
    SCOPED_TRACE(spec.name);
    EXPECT_TRUE(names.insert(spec.name).second);
    EXPECT_FALSE(spec.meaning.empty());

    const Result<Surface> surface = make_surface(spec.name, some_parameters(spec));

    ASSERT_TRUE(surface) << describe(surface.error());
    EXPECT_TRUE(make_surface(surface->model(), surface->parameters()));
  }
}

TEST(MakeSurface, RefusesAModelThatItDoesNotKnowAndNamesThoseItKnows) {
  const Result<Surface> surface = make_surface("rvp", kWheat);

  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(surface.error().seen, "there is no model \"rvp\"");
  EXPECT_THAT(surface.error().limit, HasSubstr("rpv"));
  EXPECT_EQ(surface.error().where->field, "model");
}

TEST(MakeSurface, RefusesAParameterThatTheModelDoesNotHave) {
  const Result<Surface> surface = make_surface("rpv", {{"rho", 0.133}, {"k", 0.851}, {"g", -0.114}});

  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().code, ErrorCode::UnknownKey);
  EXPECT_EQ(surface.error().seen, "there is no parameter \"rho\"");
  EXPECT_EQ(surface.error().limit, "its parameters are rho0, k, g");
  EXPECT_EQ(surface.error().where->field, "rho");
}

TEST(MakeSurface, RefusesAMissingParameter) {
  const Result<Surface> surface = make_surface("rpv", {{"rho0", 0.133}, {"g", -0.114}});

  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().code, ErrorCode::MissingKey);
  EXPECT_EQ(surface.error().where->field, "k");
}

TEST(MakeSurface, RefusesAParameterGivenTwice) {
  const Result<Surface> surface = make_surface("lambertian", {{"rho", 0.5}, {"rho", 0.6}});

  ASSERT_FALSE(surface);
  EXPECT_EQ(surface.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(surface.error().seen, "parameter \"rho\" is given 2 times");
}

TEST(MakeSurface, TakesBothEndsOfEveryRangeAndNothingBeyond) {
  for (const ModelSpec& spec : surface_models()) {
    for (std::size_t k = 0; k < spec.parameters.size(); ++k) {
      const ParameterSpec& p = spec.parameters[k];
      SCOPED_TRACE(std::string(spec.name) + "." + std::string(p.name));
      Parameters parameters = some_parameters(spec);
      const auto made_with = [&](double value) {
        parameters[k].value = value;
        return make_surface(spec.name, parameters);
      };

      EXPECT_TRUE(made_with(p.least));
      EXPECT_TRUE(made_with(p.most));
      for (const double bad : {std::nextafter(p.least, -1e300), std::nextafter(p.most, 1e300), std::nan(""),
                               std::numeric_limits<double>::infinity()}) {
        const Result<Surface> refused = made_with(bad);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
        EXPECT_EQ(refused.error().where->field, p.name);
        EXPECT_EQ(refused.error().limit, range_text(p));
      }
    }
  }
}

}  // namespace
}  // namespace gonio::reflectance
