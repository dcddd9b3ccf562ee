// What no surface, light or sampler may be made of: every factory, every field, by name. Directions, conventions,
// tables and the symmetry checks have theirs beside their own tests.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "reflectance/integral/prepared_reflectance.h"
#include "reflectance/light/beam.h"
#include "reflectance/light/cie_sky.h"
#include "reflectance/light/overcast_sky.h"
#include "reflectance/light/sun_disk.h"
#include "reflectance/light/table_sky.h"
#include "reflectance/light/uniform_sky.h"
#include "reflectance/sampling/make_sampler.h"
#include "reflectance/surface/fresnel_mirror.h"
#include "reflectance/surface/glint.h"
#include "reflectance/surface/hapke.h"
#include "reflectance/surface/lambertian.h"
#include "reflectance/surface/minnaert.h"
#include "reflectance/surface/rpv.h"
#include "reflectance/surface/surface_sum.h"
#include "reflectance/surface/water_body.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

template <class T>
std::optional<Error> error_of(const Result<T>& result) {
  return result ? std::nullopt : std::optional(result.error());
}

struct Field {
  std::string name;
  double least;
  double most;
  std::function<std::optional<Error>(double)> make;
};

std::vector<Field> fields() {
  return {
      {"rho", 0.0, 1.0, [](double x) { return error_of(Lambertian::make({.rho = x})); }},
      {"rho", 0.0, 2.0, [](double x) { return error_of(Minnaert::make({.rho = x, .k = 0.0})); }},
      {"k", -0.9, 10.0, [](double x) { return error_of(Minnaert::make({.rho = 0.5, .k = x})); }},
      {"omega0", 0.0, 1.0, [](double x) { return error_of(Hapke::make({.omega0 = x})); }},
      {"g", -0.999999, 0.999999, [](double x) { return error_of(Hapke::make({.omega0 = 0.5, .g = x})); }},
      {"omega0", 0.0, 1.0, [](double x) { return error_of(Hapke::make_from_co_albedo(x)); }},
      {"g", -0.999999, 0.999999,
       [](double x) { return error_of(Hapke::make_from_co_albedo(0.1, HapkeForm::Hapke, x)); }},
      {"rho0", 0.0, 1.0, [](double x) { return error_of(Rpv::make({.rho0 = x})); }},
      {"k", 0.0, 2.0, [](double x) { return error_of(Rpv::make({.rho0 = 0.1, .k = x})); }},
      {"g", -0.999999, 0.999999, [](double x) { return error_of(Rpv::make({.rho0 = 0.1, .g = x})); }},
      {"slope_variance", 1e-6, 1.0, [](double x) { return error_of(Glint::make({.slope_variance = x})); }},
      {"refractive_index", 1.0, 1e12,
       [](double x) { return error_of(Glint::make({.slope_variance = 0.05, .refractive_index = x})); }},
      {"refractive_index", 0.1, 1e12, [](double x) { return error_of(FresnelMirror::make({.refractive_index = x})); }},
      {"rho_w", 0.0, 1.0, [](double x) { return error_of(WaterBody::make({.rho_w = x})); }},
      {"refractive_index", 1.0, 4.0,
       [](double x) { return error_of(WaterBody::make({.rho_w = 0.1, .refractive_index = x})); }},
      {"2.weight", 0.0, 1e300,
       [](double x) {
         return error_of(SurfaceSum::make({{wheat(), 1.0}, {sea(), x}}));
       }},
  };
}

TEST(EveryFactory, RefusesNoNumbersByTheNameOfTheField) {
  for (const Field& field : fields()) {
    for (const double bad : {std::nan(""), kInf, -kInf}) {
      const std::optional<Error> error = field.make(bad);
      ASSERT_TRUE(error) << field.name << " " << bad;
      EXPECT_EQ(error->code, ErrorCode::InvalidInput);
      const std::string told = describe(*error);
      EXPECT_NE(told.find(field.name), std::string::npos) << told;
    }
  }
}

TEST(EveryFactory, TakesItsWholeRangeAndNothingBeyond) {
  for (const Field& field : fields()) {
    SCOPED_TRACE(field.name);
    EXPECT_FALSE(field.make(field.least));
    EXPECT_FALSE(field.make(field.most));
    EXPECT_TRUE(field.make(std::nextafter(field.least, -kInf)));
    const bool has_end = field.most < 1e300;
    EXPECT_EQ(field.make(std::nextafter(field.most, kInf)).has_value(), has_end);
  }
}

TEST(EveryFactory, RefusesWhatTwoFieldsTogetherMakeImpossible) {
  // With 1 + mu as printed a phase function sends the sum negative.
  EXPECT_TRUE(error_of(Hapke::make({.omega0 = 0.5, .form = HapkeForm::AsPrinted, .g = 0.1})));
  EXPECT_TRUE(error_of(Hapke::make_from_co_albedo(0.5, HapkeForm::AsPrinted, -0.1)));
  EXPECT_TRUE(error_of(SurfaceSum::make({})));
}

// Brightnesses of light: finite and at least 0.
std::vector<Field> brightnesses() {
  const Direction sun = Direction::from_angles(degrees(40), {});
  const SunPlace place{.theta = degrees(40), .phi = {}};
  return {
      {"normal_irradiance", 0.0, 1e300, [=](double x) { return error_of(Beam::make(sun, x)); }},
      {"radiance", 0.0, 1e300, [=](double x) { return error_of(SunDisk::make(place, x)); }},
      {"normal_irradiance", 0.0, 1e300,
       [=](double x) { return error_of(SunDisk::make_from_normal_irradiance(place, x)); }},
      {"radiance", 0.0, 1e300, [](double x) { return error_of(UniformSky::make(x)); }},
      {"zenith_radiance", 0.0, 1e300, [](double x) { return error_of(OvercastSky::make(x)); }},
      {"zenith_radiance", 0.0, 1e300, [=](double x) { return error_of(CieSky::make(12, sun, x)); }},
  };
}

TEST(EveryLight, RefusesABrightnessThatIsNoneByName) {
  for (const Field& field : brightnesses()) {
    EXPECT_FALSE(field.make(0.0)) << field.name;
    EXPECT_FALSE(field.make(1.5)) << field.name;
    for (const double bad : {std::nan(""), kInf, -kInf, -1e-300}) {
      const std::optional<Error> error = field.make(bad);
      ASSERT_TRUE(error) << field.name << " " << bad;
      EXPECT_EQ(error->code, ErrorCode::InvalidInput);
      EXPECT_NE(describe(*error).find(field.name), std::string::npos) << describe(*error);
    }
  }
}

TEST(EveryLight, RefusesAPlaceThatIsNone) {
  const Direction up;
  for (const int type : {0, 16, -1}) EXPECT_TRUE(error_of(CieSky::make(type, up, 1.0))) << type;
  for (const double bad : {std::nan(""), kInf, -kInf, -1.0, 180.0}) {
    EXPECT_TRUE(error_of(SunDisk::make({.theta = degrees(bad), .phi = {}}, 1.0))) << bad;
    EXPECT_TRUE(error_of(SunDisk::make({.theta = {}, .phi = {}, .radius = degrees(bad)}, 1.0))) << bad;
    EXPECT_TRUE(error_of(TableSky::make({{}, degrees(bad)}, {{}}, std::array{1.0, 1.0}))) << bad;
  }
  for (const double bad : {std::nan(""), kInf, -kInf}) {
    EXPECT_TRUE(error_of(SunDisk::make({.theta = {}, .phi = degrees(bad)}, 1.0))) << bad;
    EXPECT_TRUE(error_of(TableSky::make({{}, degrees(90)}, {{}}, std::array{1.0, bad}))) << bad;
    EXPECT_TRUE(error_of(TableSky::make({{}, degrees(90)}, {{}, degrees(bad)}, std::array{1.0, 1.0, 1.0, 1.0}))) << bad;
  }
  EXPECT_TRUE(error_of(TableSky::make({{}, degrees(90)}, {{}}, std::array{1.0})));
  EXPECT_TRUE(error_of(TableSky::make({}, {}, {})));
}

TEST(Sampler, RefusesOptionsOutOfTheirRange) {
  const Direction i = Direction::from_angles(degrees(30), {});
  for (const double bad : {std::nan(""), -kInf, -1e-3, 0.0}) {
    EXPECT_TRUE(error_of(make_sampler(wheat(), i, {.accuracy = bad}))) << bad;
  }
  EXPECT_TRUE(error_of(make_sampler(wheat(), i, {.most_cells = 511})));
  EXPECT_TRUE(error_of(make_sampler(wheat(), i, {.most_cells = (std::size_t{1} << 22U) + 1})));
}

TEST(PreparedReflectance, RefusesAToleranceOutOfItsRange) {
  for (const double bad : {std::nan(""), kInf, -kInf, -1e-6, 0.0, 1e-13, 0.02}) {
    EXPECT_TRUE(error_of(PreparedReflectance::make(wheat(), bad))) << bad;
  }
}

}  // namespace
}  // namespace gonio::reflectance
