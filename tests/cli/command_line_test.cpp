#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/invocation.h"

namespace gonio::cli {
namespace {

using testing::HasSubstr;

Invocation read(const std::vector<std::string>& arguments) {
  const auto wanted = read_command_line(arguments, "http://127.0.0.1:8470");
  EXPECT_TRUE(wanted.has_value()) << wanted.error().text;
  return wanted ? *wanted : Invocation{};
}

TEST(CommandLine, MovesNameTheirAxes) {
  const Invocation wanted = read({"stage", "move", "--theta-i", "30", "--phi-r", "-12.5"});

  EXPECT_EQ(wanted.verb, Verb::StageMove);
  EXPECT_EQ(wanted.target.theta_i_deg, 30.0);
  EXPECT_EQ(wanted.target.phi_r_deg, -12.5);
  EXPECT_FALSE(wanted.target.theta_r_deg.has_value());
}

TEST(CommandLine, TheStageAloneIsShown) {
  EXPECT_EQ(read({"stage"}).verb, Verb::StageShow);
  EXPECT_EQ(read({"stage", "reset"}).verb, Verb::StageReset);
}

TEST(CommandLine, AReadingIsLitOrDarkOrAsTheShuttersStand) {
  const Invocation lit = read({"detector", "read", "--exposure", "0.02", "--lit"});

  EXPECT_EQ(lit.verb, Verb::DetectorRead);
  EXPECT_EQ(lit.reading.exposure_s, 0.02);
  EXPECT_EQ(lit.reading.lit, true);
  EXPECT_EQ(read({"detector", "read", "--dark", "--range", "1e-3"}).reading.lit, false);
  EXPECT_EQ(read({"detector", "read", "--range", "1e-3"}).reading.range_w, 1e-3);
  EXPECT_FALSE(read({"detector", "read"}).reading.lit.has_value());
  EXPECT_FALSE(read_command_line({"detector", "read", "--lit", "--dark"}, "").has_value());
}

TEST(CommandLine, FormatAndAddressMayStandAnywhere) {
  const Invocation wanted = read({"scan", "show", "3", "-o", "json", "--connect", "unix:/tmp/s"});

  EXPECT_EQ(wanted.verb, Verb::ScanShow);
  EXPECT_EQ(wanted.scan, 3);
  EXPECT_EQ(wanted.format, Format::Json);
  EXPECT_EQ(wanted.connect, "unix:/tmp/s");
}

TEST(CommandLine, AnExportsOwnOptionIsItsFile) {
  const Invocation wanted = read({"-o", "json", "data", "export", "3", "--format", "csv", "-o", "out.csv"});

  EXPECT_EQ(wanted.verb, Verb::DataExport);
  EXPECT_EQ(wanted.file, "out.csv");
  EXPECT_EQ(wanted.format, Format::Json);
}

TEST(CommandLine, PauseTakesNowAndAReason) {
  const Invocation wanted = read({"scan", "pause", "3", "--now", "--reason", "lamp"});

  EXPECT_EQ(wanted.verb, Verb::ScanPause);
  EXPECT_TRUE(wanted.now);
  EXPECT_EQ(wanted.reason, "lamp");
}

TEST(CommandLine, WrongLinesSayWhyAndEndWithTwo) {
  const std::vector<std::vector<std::string>> wrong{
      {},      {"scan"},          {"scan", "show"},          {"scan", "show", "x"},  {"scan", "show", "-1"},
      {"fly"}, {"plan", "check"}, {"stage", "move", "--up"}, {"status", "-o", "xml"}};
  for (const auto& arguments : wrong) {
    const auto wanted = read_command_line(arguments, "");
    ASSERT_FALSE(wanted.has_value()) << testing::PrintToString(arguments);
    EXPECT_EQ(wanted.error().exit_code, 2);
    EXPECT_FALSE(wanted.error().text.empty());
  }
}

TEST(CommandLine, HelpIsNoError) {
  const auto wanted = read_command_line({"scan", "pause", "--help"}, "");

  ASSERT_FALSE(wanted.has_value());
  EXPECT_EQ(wanted.error().exit_code, 0);
  EXPECT_THAT(wanted.error().text, HasSubstr("drop the item in hand"));
}

}  // namespace
}  // namespace gonio::cli
