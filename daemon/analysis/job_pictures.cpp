// Pictures, and the page that a lab signs.
#include <algorithm>
#include <filesystem>
#include <iterator>

#include "base/read_file.h"
#include "base/write_file.h"
#include "daemon/analysis/describe.h"
#include "daemon/analysis/fit_job.h"
#include "daemon/analysis/gnuplot.h"
#include "daemon/analysis/job_parts.h"
#include "daemon/analysis/plots.h"
#include "daemon/analysis/report.h"
#include "daemon/desks/scan_review.h"

namespace gonio::analysis {

using api::AnalysisReport;

namespace {

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

// Reflectances with U of each channel, in place of those that describe_brdf has without.
Result<std::vector<api::AnalysisFact>> facts_for_page(const Subject& subject, std::vector<std::string>& notes) {
  Result<std::vector<api::AnalysisFact>> facts = describe_brdf(subject.brdf, notes);
  if (!facts) return facts;
  for (std::size_t channel = 0; channel < subject.brdf.channels.size(); ++channel) {
    const auto scan = channel_of(subject, channel);
    if (!scan) return failure(scan.error());
    const Result<Told> with_u = quantities_told(*scan);
    if (!with_u) {
      notes.push_back("no reflectance with U: " + describe(with_u.error()));
      return facts;
    }
    notes.insert(notes.end(), with_u->notes.begin(), with_u->notes.end());
    if (channel == 0) std::erase_if(*facts, [](const auto& fact) { return fact.name.starts_with("rho_dh"); });
    for (api::AnalysisFact fact : with_u->facts) {
      fact.name += channel_mark(subject.brdf, channel);
      facts->push_back(std::move(fact));
    }
  }
  return facts;
}

Result<api::ScanChecksReport> checks_for_page(const JobInput& input) {
  const auto reader = daemon::StoreReader::open(input.store_file);
  if (!reader) return failure(reader.error());
  return daemon::checks_of(**reader, input.request.scan);
}

// The best of the usual models for each channel. What cannot be fitted is said in the notes.
Told fits_for_page(const Subject& subject, const std::string& stem) {
  Told all;
  for (std::size_t channel = 0; channel < subject.brdf.channels.size(); ++channel) {
    const auto scan = channel_of(subject, channel);
    Result<Told> told = failure(scan ? Error{} : scan.error());
    if (scan) told = fit_told(*scan, "", stem + "-fit" + channel_tail(subject.brdf, channel));
    if (!told) {
      all.notes.push_back("no fit: " + describe(told.error()));
      continue;
    }
    for (api::AnalysisFact fact : told->facts) {
      fact.name += channel_mark(subject.brdf, channel);
      all.facts.push_back(std::move(fact));
    }
    all.notes.insert(all.notes.end(), told->notes.begin(), told->notes.end());
    for (Picture picture : told->pictures) {
      picture.name += channel_tail(subject.brdf, channel);
      all.pictures.push_back(std::move(picture));
    }
  }
  return all;
}

// Lobe, map, cut; budget and course; at last what the fits leave.
std::vector<Picture> pictures_for_page(const Subject& subject, const daemon::ScanHistory& history,
                                       const std::string& stem, std::vector<Picture> of_fits) {
  std::vector<std::string> said_already;  // by describe_brdf
  std::vector<Picture> pictures = pictures_of(subject.brdf, stem, said_already);
  std::ranges::move(pictures_of_scan(*subject.scan, history, stem), std::back_inserter(pictures));
  std::ranges::move(of_fits, std::back_inserter(pictures));
  return pictures;
}

}  // namespace

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

Result<AnalysisReport> run_report(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the scan");
  const Result<Subject> subject = read_subject(input);
  if (!subject) return failure(subject.error());
  const Result<daemon::ScanHistory> history = daemon::scan_history(input.store_file, input.request.scan);
  if (!history) return failure(history.error());
  progress.step(0.1, "integrating, and asking neighbours of each reading");
  ReportParts parts{.scan = *subject->scan,
                    .brdf = subject->brdf,
                    .history = *history,
                    .budget = budget_summary(subject->scan->brdf),
                    .notes = subject->notes,
                    .made_utc = iso8601(SystemClock().utc_now())};
  Result<std::vector<api::AnalysisFact>> facts = facts_for_page(*subject, parts.notes);
  if (!facts) return failure(facts.error());
  parts.facts = std::move(*facts);
  const Result<api::ScanChecksReport> checks = checks_for_page(input);
  if (!checks) return failure(checks.error());
  parts.checks = *checks;
  progress.step(0.2, "fitting");
  Told fits = fits_for_page(*subject, input.name);
  parts.fit = std::move(fits.facts);
  parts.fit_notes = std::move(fits.notes);
  Result<std::vector<ReportPicture>> drawn =
      drawn_for_page(input, pictures_for_page(*subject, *history, input.name, std::move(fits.pictures)), progress);
  if (!drawn) return failure(drawn.error());
  parts.pictures = std::move(*drawn);
  progress.step(0.95, "writing the page");
  const std::string page = report_page(parts);
  const std::string name = input.name + "-report.html";
  GONIO_TRY(write_file(input.folder + "/" + name, page));
  AnalysisReport report;
  report.files = {{.name = name, .bytes = std::ssize(page)}};
  report.notes = parts.notes;
  return report;
}

}  // namespace gonio::analysis
