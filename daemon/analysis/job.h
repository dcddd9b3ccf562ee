#pragma once

#include <string>

#include "base/result.h"
#include "daemon/analysis/progress.h"
#include "protocol/api/analysis.h"

namespace gonio::analysis {

struct JobInput {
  api::AnalysisRequest request;
  std::string store_file;  ///< of goniod; empty: `input_file` is what the job is about
  std::string input_file;
  std::string other_file;  ///< compare: a BRDF file that the store does not hold
  std::string folder;      ///< where results go; it is there
  std::string name;        ///< what their names begin with
};

/// Does one job, and tells of it. Files are written aside and renamed: each is there whole or not at all. Errors: what
/// stands in the job's way, as README.md has it.
[[nodiscard]] Result<api::AnalysisReport> run_job(const JobInput& input, Progress& progress);

}  // namespace gonio::analysis
