// What no surface may be made of: every factory, every field, by name. Directions, conventions and the symmetry checks
// have theirs beside their own tests.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

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

}  // namespace
}  // namespace gonio::reflectance
