#include "daemon/app/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

using testing::HasSubstr;

TEST(Options, HaveDefaultsOnLoopback) {
  const auto options = read_options({});

  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->address, "127.0.0.1");
  EXPECT_EQ(options->port, 8470);
  EXPECT_FALSE(options->simulate.has_value());
}

TEST(Options, TakeTheAddressApart) {
  const auto v4 = read_options({"--listen", "127.0.0.2:0"});
  const auto v6 = read_options({"--listen", "[::1]:9000"});

  ASSERT_TRUE(v4.has_value() && v6.has_value());
  EXPECT_EQ(v4->address, "127.0.0.2");
  EXPECT_EQ(v4->port, 0);
  EXPECT_EQ(v6->address, "::1");
  EXPECT_EQ(v6->port, 9000);
}

TEST(Options, RefuseWhatTheyDoNotKnow) {
  const std::vector<std::vector<std::string>> wrong{{"--instrumnet", "x"},       {"--listen", "8470"},
                                                    {"--listen", "127.0.0.1:x"}, {"--listen", "127.0.0.1:70000"},
                                                    {"--log-level", "loud"},     {"stray"}};
  for (const auto& arguments : wrong) {
    const auto options = read_options(arguments);
    ASSERT_FALSE(options.has_value()) << testing::PrintToString(arguments);
    EXPECT_EQ(options.error().exit_code, 2);
  }
}

TEST(Options, SimulateTakesASceneOrNone) {
  EXPECT_EQ(read_options({"--simulate"})->simulate, "");
  EXPECT_EQ(read_options({"--simulate", "glint", "--store", "s"})->simulate, "glint");
  EXPECT_TRUE(read_options({"--simulate", "glint", "--seed", "7"}).has_value());
}

TEST(Options, HelpIsNoError) {
  const auto options = read_options({"--help"});

  ASSERT_FALSE(options.has_value());
  EXPECT_EQ(options.error().exit_code, 0);
  EXPECT_THAT(options.error().text, HasSubstr("--ready-file"));
}

}  // namespace
}  // namespace gonio::daemon
