// openapi.yaml against the table of routes and the messages, both ways. Its layout is ours: two blanks a level, one
// line a property.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "protocol/api/json.h"
#include "protocol/api/route.h"

namespace gonio::api {
namespace {

struct Operation {
  std::string takes;
  std::string gives;
  bool has_problems = false;
};
struct Document {
  std::map<std::pair<std::string, std::string>, Operation> operations;  ///< by path and METHOD
  std::map<std::string, std::set<std::string>> schemas;                 ///< names of properties
};

std::string key_of(const std::string& line) {
  std::string key = line.substr(line.find_first_not_of(' '));
  if (key.front() == '"') return key.substr(1, key.find('"', 1) - 1);
  const std::size_t end = std::min(key.find(": "), key.size() - (key.ends_with(":") ? 1 : 0));
  return key.substr(0, end);
}

Document read_document() {
  std::ifstream in(std::string(GONIO_SOURCE_DIR) + "/protocol/api/openapi.yaml");
  EXPECT_TRUE(in.good());
  Document document;
  std::string part;
  std::string path;
  std::string schema;
  Operation* operation = nullptr;
  for (std::string line; std::getline(in, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    const std::string key = key_of(line);
    if (indent == 0) part = key;
    if (part == "components" && indent == 2) part = "components/" + key;
    if (part.starts_with("components") && indent == 2) part = "components/" + key;
    if (part == "paths" && indent == 2) path = key;
    if (part == "paths" && indent == 4) {
      operation = &document.operations[{path, key == "get" ? "GET" : key == "post" ? "POST" : key}];
    }
    if (part == "paths" && indent == 10 && key.find('/') != std::string::npos) operation->takes = key;
    if (part == "paths" && indent == 12 && key.find('/') != std::string::npos) operation->gives = key;
    if (part == "paths" && indent == 8 && key == "default") operation->has_problems = true;
    if (part == "components/schemas" && indent == 4) {
      schema = key;
      document.schemas[schema];
    }
    if (part == "components/schemas" && indent == 8) document.schemas[schema].insert(key);
  }
  return document;
}

TEST(OpenApi, HasEveryRouteWithItsContentTypesAndNoOther) {
  Document document = read_document();

  for (const Route& route : kRoutes) {
    const auto found = document.operations.find({std::string(route.path), std::string(method_name(route.method))});
    ASSERT_NE(found, document.operations.end()) << method_name(route.method) << " " << route.path;
    EXPECT_EQ(found->second.takes, route.takes) << route.path;
    EXPECT_EQ(found->second.gives, route.gives) << route.path;
    EXPECT_TRUE(found->second.has_problems) << route.path;
  }
  EXPECT_EQ(document.operations.size(), kRoutes.size());
}

TEST(OpenApi, OnlyGetsChangeNothingAndEveryChangeDeclaresItsBody) {
  for (const Route& route : kRoutes) {
    const bool is_post = route.method == Method::Post;
    EXPECT_TRUE(is_post || !route.changes) << route.path;
    EXPECT_EQ(route.takes, is_post ? kJson : std::string_view()) << route.path;
    EXPECT_EQ(route.body_limit > 0, is_post) << route.path;
  }
}

template <class T>
void expect_schema(const Document& document, const std::string& name) {
  const nlohmann::json message = nlohmann::json::parse(to_json(T{}));
  std::set<std::string> members;
  for (const auto& [member, value] : message.items()) members.insert(member);
  ASSERT_TRUE(document.schemas.contains(name)) << name;
  EXPECT_EQ(document.schemas.at(name), members) << name;
}

TEST(OpenApi, DescribesTheMembersOfEveryMessage) {
  const Document document = read_document();

  expect_schema<StageReport>(document, "StageReport");
  expect_schema<ScanReport>(document, "ScanReport");
  expect_schema<StatusReport>(document, "StatusReport");
  expect_schema<HealthReport>(document, "HealthReport");
  expect_schema<PlanReport>(document, "PlanReport");
  expect_schema<PointPage>(document, "PointPage");
  expect_schema<BrdfPage>(document, "BrdfPage");
  expect_schema<ScanList>(document, "ScanList");
  expect_schema<ReferenceReport>(document, "ReferenceReport");
  expect_schema<ReferenceList>(document, "ReferenceList");
  expect_schema<Event>(document, "Event");
  expect_schema<StopReport>(document, "StopReport");
  expect_schema<CommandReport>(document, "CommandReport");
  expect_schema<PlanSubmission>(document, "PlanSubmission");
  expect_schema<ResumeRequest>(document, "ResumeRequest");
  expect_schema<ChangeRequest>(document, "ChangeRequest");
  expect_schema<MoveRequest>(document, "MoveRequest");
  expect_schema<DetectorReadRequest>(document, "DetectorReadRequest");
  expect_schema<DetectorReading>(document, "DetectorReading");
  expect_schema<PauseRequest>(document, "PauseRequest");
  expect_schema<AbortRequest>(document, "AbortRequest");
  expect_schema<CalibrationReport>(document, "CalibrationReport");
  expect_schema<CalibrationList>(document, "CalibrationList");
  expect_schema<ChartReport>(document, "ChartReport");
  expect_schema<UseCalibrationRequest>(document, "UseCalibrationRequest");
  expect_schema<RecomputeRequest>(document, "RecomputeRequest");
  expect_schema<ReferenceImport>(document, "ReferenceImport");
  expect_schema<ScanCheckReport>(document, "ScanCheckReport");
  expect_schema<ScanChecksReport>(document, "ScanChecksReport");
  expect_schema<BudgetTermReport>(document, "BudgetTermReport");
  expect_schema<PointBudgetReport>(document, "PointBudgetReport");
  expect_schema<NoWords>(document, "NoWords");
  expect_schema<AnalysisRequest>(document, "AnalysisRequest");
  expect_schema<AnalysisReport>(document, "AnalysisReport");
  expect_schema<AnalysisList>(document, "AnalysisList");
}

}  // namespace
}  // namespace gonio::api
