// Jobs that look at one channel after the other.
#include <fmt/format.h>

#include "base/write_file.h"
#include "daemon/analysis/comparisons.h"
#include "daemon/analysis/fit_job.h"
#include "daemon/analysis/gnuplot.h"
#include "daemon/analysis/job_parts.h"

namespace gonio::analysis {

using api::AnalysisReport;
using reflectance::MeasuredScan;

namespace {

// `tell` of each channel's data, and of the stem of its files: NAME-PART, with the channel's number where there are
// several.
template <class Tell>
Result<AnalysisReport> each_channel(const JobInput& input, Progress& progress, const std::string& part,
                                    const std::string& doing, Tell tell) {
  progress.step(0.0, "reading the values");
  const Result<Subject> subject = read_subject(input);
  if (!subject) return failure(subject.error());
  AnalysisReport report;
  report.notes = subject->notes;
  const std::size_t channels = subject->brdf.channels.size();
  for (std::size_t channel = 0; channel < channels; ++channel) {
    progress.step(0.1 + 0.9 * static_cast<double>(channel) / static_cast<double>(channels), doing);
    const Result<MeasuredScan> scan = channel_of(*subject, channel);
    if (!scan) return failure(scan.error());
    const std::string stem = input.name + part + channel_tail(subject->brdf, channel);
    const Result<Told> told = tell(*scan, stem);
    if (!told) return failure(told.error());
    GONIO_TRY(take_told(*told, input, stem, channel_mark(subject->brdf, channel), report));
  }
  return report;
}

}  // namespace

Result<void> take_told(const Told& told, const JobInput& input, const std::string& stem, const std::string& mark,
                       AnalysisReport& report) {
  for (api::AnalysisFact fact : told.facts) {
    fact.name += mark;
    report.facts.push_back(std::move(fact));
  }
  report.notes.insert(report.notes.end(), told.notes.begin(), told.notes.end());
  for (const auto& [ending, text] : told.texts) {
    GONIO_TRY(write_file(input.folder + "/" + stem + ending, text));
    report.files.push_back({.name = stem + ending, .bytes = std::ssize(text)});
  }
  for (const Picture& picture : told.pictures) {
    const Result<std::vector<api::AnalysisFile>> drawn = draw(input.folder, stem, picture);
    if (!drawn) return failure(drawn.error());
    report.files.insert(report.files.end(), drawn->begin(), drawn->end());
  }
  return {};
}

Result<AnalysisReport> run_quantities(const JobInput& input, Progress& progress) {
  return each_channel(input, progress, "-quantities", "fitting and integrating",
                      [](const MeasuredScan& scan, const std::string&) { return quantities_told(scan); });
}

Result<AnalysisReport> run_fit(const JobInput& input, Progress& progress) {
  return each_channel(input, progress, "-fit", "fitting", [&](const MeasuredScan& scan, const std::string& stem) {
    return fit_told(scan, input.request.model, stem);
  });
}

Result<AnalysisReport> run_symmetry(const JobInput& input, Progress& progress) {
  return each_channel(input, progress, "-symmetry", "looking for pairs", symmetries_told);
}

}  // namespace gonio::analysis
