#include "daemon/analysis/job.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "daemon/analysis/job_parts.h"

namespace gonio::analysis {
namespace {

struct JobKind {
  std::string_view name;
  bool needs_store;
  Result<api::AnalysisReport> (*run)(const JobInput&, Progress&);
};
constexpr std::array<JobKind, 11> kJobs{{{"export", false, run_export},
                                         {"describe", false, run_describe},
                                         {"plot", false, run_plot},
                                         {"report", true, run_report},
                                         {"trace", true, run_trace},
                                         {"quantities", false, run_quantities},
                                         {"fit", false, run_fit},
                                         {"compare", false, run_compare},
                                         {"symmetry", false, run_symmetry},
                                         {"repeatability", true, run_repeatability},
                                         {"readings", true, run_readings}}};
static_assert(kJobs.size() == api::kAnalysisKinds.size());

Error no_such_kind(const JobInput& input) {
  const bool has_store = !input.store_file.empty();
  std::string known;
  for (const JobKind& job : kJobs) {
    if (has_store || !job.needs_store) known.append(known.empty() ? "" : ", ").append(job.name);
  }
  return {.code = ErrorCode::InvalidInput,
          .device = "analysis",
          .tried = "begin the job",
          .seen = "kind \"" + input.request.kind + "\"" + (has_store ? "" : " of a file"),
          .limit = std::move(known)};
}

}  // namespace

Result<api::AnalysisReport> run_job(const JobInput& input, Progress& progress) {
  const auto job = std::ranges::find(kJobs, input.request.kind, &JobKind::name);
  if (job == kJobs.end() || (job->needs_store && input.store_file.empty())) return failure(no_such_kind(input));
  Result<api::AnalysisReport> report = job->run(input, progress);
  if (!report) return report;
  report->kind = input.request.kind;
  report->scan = input.request.scan;
  report->state = "done";
  report->progress = 1.0;
  return report;
}

}  // namespace gonio::analysis
