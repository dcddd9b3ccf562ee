#include "drivers/links/aravis_camera_link.h"

#include <gtest/gtest.h>

namespace gonio::drivers {
namespace {

TEST(AravisCameraLink, SearchesForNoNames) {
  AravisCameraLink link({.address = "Fake_1"});

  const auto opened = link.open();

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, ErrorCode::InvalidInput);
}

TEST(AravisCameraLink, IsUnreachableWhereThereIsNoCamera) {
  AravisCameraLink link({.address = "127.0.77.1"});

  const auto opened = link.open();

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, ErrorCode::Unreachable);
  EXPECT_FALSE(link.is_open());
}

TEST(AravisCameraLink, RefusesToWorkBeforeItIsOpen) {
  AravisCameraLink link({.address = "127.0.77.1"});

  const auto triggered = link.trigger();
  const auto popped = link.pop(Duration::zero());

  ASSERT_FALSE(triggered.has_value() || popped.has_value());
  EXPECT_EQ(triggered.error().code, ErrorCode::WrongState);
  EXPECT_EQ(popped.error().code, ErrorCode::WrongState);
}

}  // namespace
}  // namespace gonio::drivers
