#include "cli/plan_files.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "base/read_file.h"
#include "base/toml_reader.h"

namespace gonio::cli {

namespace {

std::vector<std::string> files_named_in(const std::string& plan, const std::string& path) {
  Result<TomlReader> root = TomlReader::parse(plan, path);
  if (!root || root->kind("geometry") != TomlKind::Table) return {};
  TomlReader geometry = root->table("geometry");
  std::vector<TomlReader> tables{geometry};
  if (geometry.kind("parts") == TomlKind::Array) {
    for (const TomlReader& part : geometry.tables("parts")) tables.push_back(part);
  }
  std::vector<std::string> names;
  for (TomlReader& table : tables) {
    if (!table.has_failed() && table.kind("points") == TomlKind::Text) names.push_back(table.text("points"));
  }
  return names;
}

}  // namespace

Result<api::PlanSubmission> read_plan(const std::string& path) {
  Result<std::string> plan = read_file(path);
  if (!plan) return failure(plan.error());
  api::PlanSubmission submission{.plan = std::move(*plan), .plan_file = path, .parts = {}};
  for (const std::string& name : files_named_in(submission.plan, path)) {
    Result<std::string> text = read_file((std::filesystem::path(path).parent_path() / name).string());
    if (!text) return failure(text.error());
    submission.parts.emplace(name, std::move(*text));
  }
  return submission;
}

}  // namespace gonio::cli
