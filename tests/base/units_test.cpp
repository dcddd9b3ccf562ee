#include "base/units.h"

#include <gtest/gtest.h>

#include <concepts>

namespace gonio {
namespace {

using namespace literals;

template <class A, class B>
concept Addable = requires(A a, B b) {
  a + b;
};

static_assert(Addable<Angle, Angle>);
static_assert(!Addable<Angle, Wavelength>);
static_assert(!Addable<Angle, double>);
static_assert(!std::convertible_to<double, Angle>);
static_assert(sizeof(Brdf) == sizeof(double));

TEST(Units, KeepTheNumberThatWasPutIn) {
  EXPECT_DOUBLE_EQ(in_degrees(30_deg), 30.0);
  EXPECT_DOUBLE_EQ(in_nanometres(568_nm), 568.0);
  EXPECT_DOUBLE_EQ(in_millimetres(millimetres(12.5)), 12.5);
  EXPECT_DOUBLE_EQ(in_celsius(celsius(21.5)), 21.5);
}

TEST(Units, AreSiInside) {
  EXPECT_DOUBLE_EQ((180_deg).si(), 3.14159265358979323846);
  EXPECT_DOUBLE_EQ((1_nm).si(), 1e-9);
}

TEST(Units, OfOneKindAddScaleAndDivideToANumber) {
  EXPECT_DOUBLE_EQ(in_degrees(30_deg + 15_deg), 45.0);
  EXPECT_DOUBLE_EQ(in_degrees(2.0 * 30_deg - 15_deg), 45.0);
  EXPECT_DOUBLE_EQ(30_deg / 15_deg, 2.0);
  EXPECT_LT(10_deg, 11_deg);
}

}  // namespace
}  // namespace gonio
