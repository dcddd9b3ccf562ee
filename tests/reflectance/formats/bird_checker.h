#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/reflectance/formats/shared_data.h"
#include "tests/support/process.h"

namespace gonio::formats {

/// What ajv's 2020 build says of these BiRD files by the published schema: exit code 0, or 1 with each file that is not
/// valid and why. Nothing where the schema is not there; any other code where node or ajv is not (scripts/test installs
/// it). `folder` keeps what it says.
[[nodiscard]] inline std::optional<test::Finished> checked_by_ajv(const std::vector<std::string>& files,
                                                                  const std::string& folder) {
  const std::filesystem::path schemas = shared_folder() / "schemas/bird";
  if (!std::filesystem::exists(schemas)) return std::nullopt;
  const std::string checker = std::string(GONIO_SOURCE_DIR) + "/tests/reflectance/formats/check_bird.js";
  std::vector<std::string> command{"/usr/bin/env", "node", checker, schemas.string()};
  command.insert(command.end(), files.begin(), files.end());
  constexpr std::chrono::seconds kDeadline{60};
  return test::run_program(command, folder, kDeadline);
}

}  // namespace gonio::formats
