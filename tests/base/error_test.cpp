#include "base/error.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace gonio {
namespace {

TEST(ErrorTable, HasARowOfItsOwnForEveryCode) {
  std::set<std::string_view> names;
  for (const ErrorTraits& row : all_error_traits()) {
    EXPECT_EQ(&traits(row.code), &row);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(error_code_from_name(row.name), row.code);
  }
}

TEST(ErrorTable, SaysWhatItMeansAndWhatToDo) {
  for (const ErrorTraits& row : all_error_traits()) {
    EXPECT_FALSE(row.title.empty()) << row.name;
    EXPECT_FALSE(row.for_the_data.empty()) << row.name;
    EXPECT_FALSE(row.remedy.empty()) << row.name;
    EXPECT_GE(row.http_status, 400) << row.name;
    EXPECT_LT(row.http_status, 600) << row.name;
    EXPECT_GE(row.exit_code, 1) << row.name;
    EXPECT_LE(row.exit_code, 7) << row.name;
  }
}

TEST(ErrorTable, DoesNotKnowAnUnknownName) {
  EXPECT_EQ(error_code_from_name("no-such-code"), std::nullopt);
}

TEST(Error, SpeaksInOneSentenceWithPlaceDeedSightAndLimit) {
  const Error error{.code = ErrorCode::OutOfLimits,
                    .device = "stage",
                    .tried = "move theta_r",
                    .seen = "target 97.200 deg",
                    .limit = "at most 90.000 deg",
                    .where = InputLocation{"wheat.toml", 7, "geometry.theta_r_deg"}};

  EXPECT_EQ(describe(error),
            "wheat.toml:7: geometry.theta_r_deg: stage: move theta_r: target 97.200 deg; limit: at most 90.000 deg "
            "[out-of-limits]");
}

TEST(Error, StaysOnItsLineWhateverADeviceSaid) {
  const Error error{
      .code = ErrorCode::BadReply, .device = "monitor", .tried = "ask", .seen = "1.5\n\x1B[2J\x7F, 22 \u00B0C"};

  EXPECT_EQ(describe(error), "monitor: ask: 1.5\\x0A\\x1B[2J\\x7F, 22 \u00B0C [bad-reply]");
}

TEST(Error, ExplainsWhatToDo) {
  const Error error{.code = ErrorCode::Stopped, .device = "stage", .tried = "move", .seen = "STOP"};

  const std::string text = explain(error);

  EXPECT_NE(text.find("The motion was stopped"), std::string::npos) << text;
  EXPECT_NE(text.find("gonioctl stage reset"), std::string::npos) << text;
}

}  // namespace
}  // namespace gonio
