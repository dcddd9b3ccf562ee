#include "protocol/stage/axis.h"

#include <gtest/gtest.h>

namespace gonio::stage {
namespace {

TEST(Axis, IsFoundByTheNameItIsWrittenWith) {
  for (const Axis axis : kAllAxes) {
    const auto found = axis_from_name(axis_name(axis));

    ASSERT_TRUE(found.has_value()) << axis_name(axis);
    EXPECT_EQ(*found, axis);
  }
}

TEST(Axis, HasTheNamesAndUnitsOfTheUsersFiles) {
  EXPECT_EQ(axis_name(Axis::ThetaI), "theta_i");
  EXPECT_EQ(axis_name(Axis::FilterWheel), "filter_wheel");
  EXPECT_EQ(axis_unit(Axis::PhiR), "deg");
  EXPECT_EQ(axis_unit(Axis::Carriage), "mm");
  EXPECT_EQ(axis_unit(Axis::FilterWheel), "slot");
}

TEST(Axis, IsNotFoundByAForeignName) {
  EXPECT_FALSE(axis_from_name("theta").has_value());
}

}  // namespace
}  // namespace gonio::stage
