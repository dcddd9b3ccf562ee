// Exports, descriptions, and the way down to raw readings.
#include <fmt/format.h>

#include "base/write_file.h"
#include "daemon/analysis/budget_summary.h"
#include "daemon/analysis/describe.h"
#include "daemon/analysis/environment.h"
#include "daemon/analysis/export_job.h"
#include "daemon/analysis/job_parts.h"
#include "daemon/analysis/trace.h"
#include "daemon/results/calibration_desk.h"

namespace gonio::analysis {

using api::AnalysisReport;

namespace {

// The lines of the report's budget.
void add_budget(std::vector<api::AnalysisFact>& facts, const StoredScan& scan) {
  constexpr double kPercent = 100.0;
  for (const BudgetLine& line : budget_summary(scan.brdf)) {
    facts.push_back({.name = "u of " + line.name + ", median",
                     .value = kPercent * line.median,
                     .unit = "%",
                     .note = fmt::format("worst {:.6g} %", kPercent * line.worst)});
  }
}

}  // namespace

Result<AnalysisReport> run_export(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the values");
  const Result<Subject> subject = read_subject(input);
  if (!subject) return failure(subject.error());
  progress.step(0.2, "writing " + input.request.format);
  const Result<formats::Export> written = exported(subject->brdf, input.request.format);
  if (!written) return failure(written.error());
  progress.step(0.9, "to the disk");
  Result<std::vector<api::AnalysisFile>> files = write_files(input.folder, input.name, *written);
  if (!files) return failure(files.error());
  AnalysisReport report;
  report.files = std::move(*files);
  report.losses = losses_of(written->losses);
  report.notes = subject->notes;
  return report;
}

Result<AnalysisReport> run_describe(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the values");
  const Result<Subject> subject = read_subject(input);
  if (!subject) return failure(subject.error());
  progress.step(0.3, "integrating, and asking neighbours of each reading");
  AnalysisReport report;
  report.notes = subject->notes;
  Result<std::vector<api::AnalysisFact>> facts = describe_brdf(subject->brdf, report.notes);
  if (!facts) return failure(facts.error());
  report.facts = std::move(*facts);
  if (subject->scan) add_budget(report.facts, *subject->scan);
  return report;
}

Result<AnalysisReport> run_trace(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the scan");
  const auto reader = daemon::StoreReader::open(input.store_file);
  if (!reader) return failure(reader.error());
  const Result<StoredScan> scan = read_stored_scan(**reader, input.request.scan);
  if (!scan) return failure(scan.error());
  const auto point = static_cast<std::int32_t>(input.request.point.value_or(-1));
  const Result<daemon::PointTrace> trace = daemon::trace_point(input.store_file, scan->info.id, point);
  if (!trace) return failure(trace.error());
  progress.step(0.3, "computing the values anew");
  const Result<daemon::NewBrdf> recomputed = daemon::compute_brdf(**reader, scan->info.id);
  if (!recomputed) return failure(recomputed.error());
  const Result<std::string> text = trace_text(*scan, *trace, point, *recomputed);
  if (!text) return failure(text.error());
  AnalysisReport report;
  const std::string name = fmt::format("{}-point-{}.txt", input.name, point);
  GONIO_TRY(write_file(input.folder + "/" + name, *text));
  report.files = {{.name = name, .bytes = std::ssize(*text)}};
  return report;
}

Result<AnalysisReport> run_readings(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the readings");
  const Result<daemon::ScanHistory> history = daemon::scan_history(input.store_file, input.request.scan);
  if (!history) return failure(history.error());
  const std::string name = input.name + "-readings.csv";
  const std::string table = readings_table(history->readings);
  GONIO_TRY(write_file(input.folder + "/" + name, table));
  AnalysisReport report;
  report.facts = environment_facts(history->readings);
  report.files = {{.name = name, .bytes = std::ssize(table)}};
  return report;
}

}  // namespace gonio::analysis
