#include "protocol/api/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gonio::api {
namespace {

using testing::HasSubstr;

TEST(Json, EveryErrorComesBackFromItsProblemUnchanged) {
  for (const ErrorTraits& row : all_error_traits()) {
    const Error error{.code = row.code,
                      .device = "stage",
                      .tried = "move theta_r to 97.200 deg",
                      .seen = "\"target\"\n97.200 \xC2\xB0",
                      .limit = "at most 90.000 deg",
                      .where = InputLocation{"wheat.toml", 7, "geometry.theta_r_deg"}};

    const Error back = error_from_problem(row.http_status, to_problem_json(error));

    EXPECT_EQ(back, error) << row.name;
  }
}

TEST(Json, AProblemHasTheMembersOfItsRfc) {
  const std::string text = to_problem_json({.code = ErrorCode::OutOfLimits, .device = "stage", .seen = "97.2 deg"});

  EXPECT_THAT(text, HasSubstr("\"type\":\"urn:goniod:error:out-of-limits\""));
  EXPECT_THAT(text, HasSubstr("\"status\":422"));
  EXPECT_THAT(text, HasSubstr("\"title\":"));
  EXPECT_THAT(text, HasSubstr("\"detail\":\"stage: 97.2 deg [out-of-limits]\""));
}

TEST(Json, AnAnswerThatIsNoProblemIsABadReplyWithItsFirstWords) {
  const Error error = error_from_problem(502, "<html>Bad gateway</html>");

  EXPECT_EQ(error.code, ErrorCode::BadReply);
  EXPECT_THAT(error.seen, HasSubstr("502"));
  EXPECT_THAT(error.seen, HasSubstr("Bad gateway"));
}

TEST(Json, AReportOfANewerDaemonIsStillRead) {
  const Result<CommandReport> report = report_from_json<CommandReport>(R"({"scan": 3, "of_tomorrow": [1, 2]})");

  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->scan, 3);
}

TEST(Json, ATruncatedReportIsABadReply) {
  EXPECT_EQ(report_from_json<StatusReport>(R"({"version": "0.1)").error().code, ErrorCode::BadReply);
}

TEST(Json, OptionalMembersKeepTheirAbsence) {
  ScanReport scan{.id = 3, .holds = {{.name = "lamp", .owner = "monitor", .reason = "0.1 of 0.2", .age_s = 1.5}}};
  scan.remaining_s = 12.5;

  const Result<ScanReport> back = report_from_json<ScanReport>(to_json(scan));

  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->remaining_s, 12.5);
  EXPECT_FALSE(back->median_relative_u.has_value());
  EXPECT_EQ(back->holds.at(0).reason, "0.1 of 0.2");
}

TEST(Json, RequestsAreReadStrictly) {
  EXPECT_EQ(request_from_json<MoveRequest>(R"({"theta_i": 3})").error().code, ErrorCode::UnknownKey);
  EXPECT_EQ(request_from_json<MoveRequest>(R"({"theta_i_deg": true})").error().where->field, "theta_i_deg");
  EXPECT_EQ(request_from_json<MoveRequest>("3").error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(request_from_json<PauseRequest>(R"({"now": 1})").error().code, ErrorCode::InvalidInput);
  EXPECT_TRUE(request_from_json<NoWords>("").has_value());
  EXPECT_EQ(request_from_json<MoveRequest>(R"({"theta_i_deg": 30, "phi_r_deg": null})")->theta_i_deg, 30.0);
}

TEST(Json, TextThatIsNotUtf8DoesNotBreakAnAnswer) {
  EXPECT_THAT(to_json(HealthReport{.ok = true, .version = "\xFF\xFE"}), HasSubstr("\"ok\":true"));
}

}  // namespace
}  // namespace gonio::api
