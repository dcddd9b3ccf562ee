#include "daemon/analysis/job.h"

#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "base/read_file.h"
#include "base/write_file.h"
#include "daemon/analysis/describe.h"
#include "daemon/analysis/export_job.h"
#include "daemon/analysis/fit_job.h"
#include "daemon/analysis/gnuplot.h"
#include "daemon/analysis/input_file.h"
#include "daemon/analysis/plots.h"
#include "daemon/analysis/report.h"
#include "daemon/analysis/scan_data.h"
#include "daemon/analysis/stored_scan.h"
#include "daemon/analysis/trace.h"
#include "daemon/results/calibration_desk.h"
#include "reflectance/formats/scan_of_file.h"

namespace gonio::analysis {
namespace {

using api::AnalysisReport;

// What a job works on: a stored scan, or a file.
struct Subject {
  std::optional<StoredScan> scan;
  formats::MeasuredBrdf brdf;
  std::vector<std::string> notes;
};

Result<StoredScan> read_scan(const JobInput& input) {
  const auto reader = daemon::StoreReader::open(input.store_file);
  if (!reader) return failure(reader.error());
  return read_stored_scan(**reader, input.request.scan);
}

Result<Subject> read_subject(const JobInput& input) {
  Subject subject;
  if (input.store_file.empty()) {
    Result<InputFile> file = read_input_file(input.input_file);
    if (!file) return failure(file.error());
    subject.brdf = std::move(file->brdf);
    subject.notes.push_back(fmt::format("read as {}", formats::format_name(file->format)));
    return subject;
  }
  Result<StoredScan> scan = read_scan(input);
  if (!scan) return failure(scan.error());
  Result<formats::MeasuredBrdf> brdf = measured_brdf(*scan);
  if (!brdf) return failure(brdf.error());
  subject.brdf = std::move(*brdf);
  subject.notes = notes_on(*scan, subject.brdf);
  subject.scan = std::move(*scan);
  return subject;
}

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

// Each picture with its tables and script; `done` of the job lies before, the rest of it up to 1 is for these.
Result<std::vector<api::AnalysisFile>> draw_all(const JobInput& input, const std::vector<Picture>& pictures,
                                                double done, Progress& progress) {
  std::vector<api::AnalysisFile> files;
  for (std::size_t n = 0; n < pictures.size(); ++n) {
    const double share = static_cast<double>(n) / static_cast<double>(pictures.size());
    progress.step(done + (1.0 - done) * share, "drawing " + pictures[n].name);
    const Result<std::vector<api::AnalysisFile>> drawn = draw(input.folder, input.name, pictures[n]);
    if (!drawn) return failure(drawn.error());
    files.insert(files.end(), drawn->begin(), drawn->end());
  }
  return files;
}

Result<AnalysisReport> run_plot(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the values");
  const Result<Subject> subject = read_subject(input);
  if (!subject) return failure(subject.error());
  progress.step(0.1, "reading between the readings");
  AnalysisReport report;
  report.notes = subject->notes;
  std::vector<Picture> pictures = pictures_of(subject->brdf, input.name, report.notes);
  if (subject->scan) {
    const Result<daemon::ScanHistory> history = daemon::scan_history(input.store_file, input.request.scan);
    if (!history) return failure(history.error());
    for (Picture& picture : pictures_of_scan(*subject->scan, *history, input.name)) {
      pictures.push_back(std::move(picture));
    }
  }
  Result<std::vector<api::AnalysisFile>> files = draw_all(input, pictures, 0.3, progress);
  if (!files) return failure(files.error());
  report.files = std::move(*files);
  return report;
}

// Pictures for a page: drawn in a folder of their own, which goes with them.
Result<std::vector<ReportPicture>> drawn_for_page(const JobInput& input, const std::vector<Picture>& pictures,
                                                  Progress& progress) {
  const std::string folder = input.folder + "/." + input.name + "-pictures";
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  std::vector<ReportPicture> drawn;
  Result<void> done;
  for (std::size_t n = 0; done && n < pictures.size(); ++n) {
    progress.step(0.3 + 0.6 * static_cast<double>(n) / static_cast<double>(pictures.size()),
                  "drawing " + pictures[n].name);
    const auto files = draw(folder, input.name, pictures[n]);
    if (!files) done = failure(files.error());
    if (!done) break;
    Result<std::string> svg = read_file(folder + "/" + input.name + "-" + pictures[n].name + ".svg");
    if (!svg) done = failure(svg.error());
    if (svg) drawn.push_back({.caption = pictures[n].caption, .svg = std::move(*svg)});
  }
  std::filesystem::remove_all(folder, ignored);
  if (!done) return failure(done.error());
  return drawn;
}

// One channel as data.
Result<reflectance::MeasuredScan> channel_of(const Subject& subject, std::size_t channel) {
  if (subject.scan) return scan_data(*subject.scan, subject.brdf, channel);
  return formats::scan_of(subject.brdf, channel);
}

std::string channel_mark(const formats::MeasuredBrdf& brdf, std::size_t channel) {
  return brdf.channels.size() == 1 ? "" : " at " + brdf.channels[channel].name;
}

// Reflectances with U of each channel, in place of those that describe_brdf has without.
Result<std::vector<api::AnalysisFact>> facts_for_page(const Subject& subject, std::vector<std::string>& notes) {
  Result<std::vector<api::AnalysisFact>> facts = describe_brdf(subject.brdf, notes);
  if (!facts) return facts;
  for (std::size_t channel = 0; channel < subject.brdf.channels.size(); ++channel) {
    const auto scan = channel_of(subject, channel);
    if (!scan) return failure(scan.error());
    const auto with_u = quantities_told(*scan, notes);
    if (!with_u) {
      notes.push_back("no reflectance with U: " + describe(with_u.error()));
      return facts;
    }
    if (channel == 0) std::erase_if(*facts, [](const auto& fact) { return fact.name.starts_with("rho_dh"); });
    for (api::AnalysisFact fact : *with_u) {
      fact.name += channel_mark(subject.brdf, channel);
      facts->push_back(std::move(fact));
    }
  }
  return facts;
}

Result<AnalysisReport> run_report(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the scan");
  const Result<Subject> subject = read_subject(input);
  if (!subject) return failure(subject.error());
  const Result<daemon::ScanHistory> history = daemon::scan_history(input.store_file, input.request.scan);
  if (!history) return failure(history.error());
  progress.step(0.1, "integrating, and asking neighbours of each reading");
  std::vector<std::string> notes = subject->notes;
  Result<std::vector<api::AnalysisFact>> facts = facts_for_page(*subject, notes);
  if (!facts) return failure(facts.error());
  std::vector<std::string> said_already;  // by describe_brdf
  std::vector<Picture> pictures = pictures_of(subject->brdf, input.name, said_already);
  for (Picture& picture : pictures_of_scan(*subject->scan, *history, input.name)) {
    pictures.push_back(std::move(picture));
  }
  Result<std::vector<ReportPicture>> drawn = drawn_for_page(input, pictures, progress);
  if (!drawn) return failure(drawn.error());
  progress.step(0.95, "writing the page");
  const std::string page = report_page({.scan = *subject->scan,
                                        .brdf = subject->brdf,
                                        .history = *history,
                                        .budget = budget_summary(subject->scan->brdf),
                                        .facts = std::move(*facts),
                                        .pictures = std::move(*drawn),
                                        .notes = notes,
                                        .made_utc = iso8601(SystemClock().utc_now())});
  const std::string name = input.name + "-report.html";
  GONIO_TRY(write_file(input.folder + "/" + name, page));
  AnalysisReport report;
  report.files = {{.name = name, .bytes = std::ssize(page)}};
  report.notes = notes;
  return report;
}

Result<AnalysisReport> run_quantities(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the values");
  const Result<Subject> subject = read_subject(input);
  if (!subject) return failure(subject.error());
  AnalysisReport report;
  report.notes = subject->notes;
  const std::size_t channels = subject->brdf.channels.size();
  for (std::size_t channel = 0; channel < channels; ++channel) {
    progress.step(0.1 + 0.9 * static_cast<double>(channel) / static_cast<double>(channels), "fitting and integrating");
    const auto scan = channel_of(*subject, channel);
    if (!scan) return failure(scan.error());
    Result<std::vector<api::AnalysisFact>> facts = quantities_told(*scan, report.notes);
    if (!facts) return failure(facts.error());
    for (api::AnalysisFact& fact : *facts) {
      fact.name += channel_mark(subject->brdf, channel);
      report.facts.push_back(std::move(fact));
    }
  }
  return report;
}

Result<AnalysisReport> run_fit(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the values");
  const Result<Subject> subject = read_subject(input);
  if (!subject) return failure(subject.error());
  AnalysisReport report;
  report.notes = subject->notes;
  const std::size_t channels = subject->brdf.channels.size();
  for (std::size_t channel = 0; channel < channels; ++channel) {
    progress.step(0.1 + 0.8 * static_cast<double>(channel) / static_cast<double>(channels), "fitting");
    const std::string stem = input.name + "-fit" + (channels == 1 ? "" : "-" + std::to_string(channel + 1));
    const auto scan = channel_of(*subject, channel);
    if (!scan) return failure(scan.error());
    const Result<FitTold> told = fit_told(*scan, input.request.model, stem);
    if (!told) return failure(told.error());
    for (api::AnalysisFact fact : told->facts) {
      fact.name += channel_mark(subject->brdf, channel);
      report.facts.push_back(std::move(fact));
    }
    report.notes.insert(report.notes.end(), told->notes.begin(), told->notes.end());
    if (!told->scene.empty()) {
      GONIO_TRY(write_file(input.folder + "/" + stem + ".toml", told->scene));
      report.files.push_back({.name = stem + ".toml", .bytes = std::ssize(told->scene)});
    }
    const Result<std::vector<api::AnalysisFile>> drawn = draw(input.folder, stem, told->residuals);
    if (!drawn) return failure(drawn.error());
    report.files.insert(report.files.end(), drawn->begin(), drawn->end());
  }
  return report;
}

Result<AnalysisReport> run_compare(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the first scan");
  const Result<Subject> first = read_subject(input);
  if (!first) return failure(first.error());
  JobInput of_other = input;
  of_other.request.scan = input.request.other_scan;
  progress.step(0.3, "reading the second scan");
  const Result<Subject> second = read_subject(of_other);
  if (!second) return failure(second.error());
  const auto a = channel_of(*first, 0);
  if (!a) return failure(a.error());
  const auto b = channel_of(*second, 0);
  if (!b) return failure(b.error());
  progress.step(0.6, "comparing");
  const Result<ComparisonTold> told = comparison_told(*a, *b);
  if (!told) return failure(told.error());
  AnalysisReport report;
  report.facts = told->facts;
  const std::string name = fmt::format("{}-against-{}.csv", input.name, input.request.other_scan);
  GONIO_TRY(write_file(input.folder + "/" + name, told->table));
  report.files = {{.name = name, .bytes = std::ssize(told->table)}};
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

Error no_such_kind(const JobInput& input) {
  return {.code = ErrorCode::InvalidInput,
          .device = "analysis",
          .tried = "begin the job",
          .seen = "kind \"" + input.request.kind + "\"" + (input.store_file.empty() ? " of a file" : ""),
          .limit = input.store_file.empty() ? "export, describe, plot, quantities, fit"
                                            : "export, describe, plot, quantities, fit, report, compare, trace"};
}

}  // namespace

Result<AnalysisReport> run_job(const JobInput& input, Progress& progress) {
  const bool has_store = !input.store_file.empty();
  Result<AnalysisReport> report = failure(no_such_kind(input));
  if (input.request.kind == "export") report = run_export(input, progress);
  if (input.request.kind == "describe") report = run_describe(input, progress);
  if (input.request.kind == "plot") report = run_plot(input, progress);
  if (input.request.kind == "report" && has_store) report = run_report(input, progress);
  if (input.request.kind == "quantities") report = run_quantities(input, progress);
  if (input.request.kind == "fit") report = run_fit(input, progress);
  if (input.request.kind == "compare" && has_store) report = run_compare(input, progress);
  if (input.request.kind == "trace" && has_store) report = run_trace(input, progress);
  if (!report) return report;
  report->kind = input.request.kind;
  report->scan = input.request.scan;
  report->state = "done";
  report->progress = 1.0;
  return report;
}

}  // namespace gonio::analysis
