#include <fmt/format.h>

#include "cli/views.h"

namespace gonio::cli {
namespace {

const std::vector<std::string> kJobColumns{"job", "kind", "scan", "state", "progress", "doing", "submitted", "who"};

std::vector<std::string> job_row(const api::AnalysisReport& job) {
  const std::string doing = job.error ? describe(*job.error) : job.doing;
  return {std::to_string(job.id),
          job.kind,
          std::to_string(job.scan),
          job.state,
          fmt::format("{:.0f} %", 100.0 * job.progress),
          doing,
          job.submitted_utc,
          job.who};
}

}  // namespace

Table view(const api::AnalysisReport& job) {
  return {.header = kJobColumns, .rows = {job_row(job)}};
}

Table view(const api::AnalysisList& jobs) {
  Table table{.header = kJobColumns, .rows = {}};
  for (const api::AnalysisReport& job : jobs.jobs) table.rows.push_back(job_row(job));
  return table;
}

}  // namespace gonio::cli
