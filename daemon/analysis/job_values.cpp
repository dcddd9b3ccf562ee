// Exports, descriptions, and the way down to raw readings.
#include <fmt/format.h>

#include "base/write_file.h"
#include "daemon/analysis/describe.h"
#include "daemon/analysis/export_job.h"
#include "daemon/analysis/job_parts.h"
#include "daemon/analysis/trace.h"
#include "daemon/results/calibration_desk.h"

namespace gonio::analysis {

using api::AnalysisReport;

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

}  // namespace gonio::analysis
