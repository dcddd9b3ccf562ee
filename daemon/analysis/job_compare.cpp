// A scan beside another scan, a file, a model; all scans of a sample beside each other.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "daemon/analysis/comparisons.h"
#include "daemon/analysis/fit_job.h"
#include "daemon/analysis/job_parts.h"
#include "daemon/analysis/model_text.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::analysis {

using api::AnalysisReport;
using formats::MeasuredBrdf;
using reflectance::MeasuredScan;

namespace {

constexpr int kScansAtOnce = 200;

// A model by its numbers, or by its name alone: then it is fitted to the scan.
Result<Told> model_compared(const MeasuredScan& scan, const std::string& model, const std::string& stem) {
  if (model.find('=') != std::string::npos) {
    const Result<reflectance::Surface> surface = surface_of_text(model);
    if (!surface) return failure(surface.error());
    return surface_compared(scan, {.name = model, .surface = *surface}, stem);
  }
  const Result<fit::FitResult> fit = fitted_model(scan, model);
  if (!fit) return failure(fit.error());
  return surface_compared(
      scan, {.name = text_of_surface(fit->surface), .surface = fit->surface, .spent = fit->free_names.size()}, stem);
}

Error no_such_channel(const MeasuredBrdf& first, std::size_t channel, const MeasuredBrdf& other) {
  std::string names;
  for (const formats::Channel& c : other.channels) names.append(names.empty() ? "" : ", ").append(c.name);
  return {.code = ErrorCode::InvalidInput,
          .device = "analysis",
          .tried = "compare channel " + first.channels[channel].name,
          .seen = "the other has " + names,
          .limit = "the same wavelength within 1 nm, or one channel each"};
}

// A file may name a channel and have no reading of it.
Error empty_channel(const MeasuredBrdf& other, std::size_t channel) {
  return {.code = ErrorCode::InvalidInput,
          .device = "analysis",
          .tried = "compare with channel " + other.channels[channel].name + " of the other",
          .seen = "no reading of it",
          .limit = "readings that make a surface"};
}

// The other's channel of the same wavelength; where both have one only, that one.
Result<std::size_t> partner_channel(const MeasuredBrdf& first, std::size_t channel, const MeasuredBrdf& other) {
  constexpr double kSameNm = 1.0;
  if (first.channels.size() == 1 && other.channels.size() == 1) return std::size_t{0};
  for (std::size_t k = 0; k < other.channels.size(); ++k) {
    const double off = other.channels[k].wavelength_nm - first.channels[channel].wavelength_nm;
    if (std::abs(off) <= kSameNm) return k;
  }
  return failure(no_such_channel(first, channel, other));
}

// Coarse files are compared, too: what lies between readings as far apart as these has an uncertainty that says so.
constexpr Angle kWidestCompared = degrees(60.0);

// Directions of a file seldom are those of a scan: it is read as the table that a scene's `file` makes of it.
Result<Told> file_compared(const MeasuredScan& scan, const Subject& other, std::size_t channel, const std::string& name,
                           const std::string& stem) {
  const Result<formats::SurfaceFile> surfaces =
      formats::surfaces_of(other.brdf, {.widest_cell = kWidestCompared, .widest_incidence_step = kWidestCompared});
  if (!surfaces) return failure(surfaces.error());
  const auto made =
      std::ranges::find(surfaces->channels, other.brdf.channels[channel], &formats::ChannelSurface::channel);
  const auto* table = made == surfaces->channels.end() ? nullptr : made->surface.as<reflectance::TabulatedSurface>();
  if (table == nullptr) return failure(empty_channel(other.brdf, channel));
  const Result<MeasuredScan> readings = channel_of(other, channel);
  if (!readings) return failure(readings.error());
  return table_compared(scan, {.name = name, .table = *table, .readings = *readings}, stem);
}

// What the first is compared with.
struct Partner {
  std::optional<Subject> subject;
  std::string name;  ///< for names of files
};

Result<Partner> read_partner(const JobInput& input) {
  const api::AnalysisRequest& request = input.request;
  if (!request.other_model.empty()) return Partner{.subject = std::nullopt, .name = "model"};
  const bool is_file = !input.other_file.empty();
  if (!is_file && (request.other_scan <= 0 || input.store_file.empty())) {
    return failure({.code = ErrorCode::InvalidInput,
                    .device = "analysis",
                    .tried = "compare",
                    .seen = "nothing to compare with",
                    .limit = "another scan, a file, or a model"});
  }
  Result<Subject> other =
      is_file ? read_file_subject(input.other_file) : read_stored_subject(input.store_file, request.other_scan);
  if (!other) return failure(other.error());
  return Partner{
      .subject = std::move(*other),
      .name = is_file ? std::filesystem::path(input.other_file).stem().string() : std::to_string(request.other_scan)};
}

Result<Told> compared_told(const JobInput& input, const Subject& first, const Partner& partner, std::size_t channel,
                           const std::string& stem) {
  const Result<MeasuredScan> scan = channel_of(first, channel);
  if (!scan) return failure(scan.error());
  if (!partner.subject) return model_compared(*scan, input.request.other_model, stem);
  const Result<std::size_t> other = partner_channel(first.brdf, channel, partner.subject->brdf);
  if (!other) return failure(other.error());
  if (!partner.subject->scan) return file_compared(*scan, *partner.subject, *other, partner.name, stem);
  const Result<MeasuredScan> second = channel_of(*partner.subject, *other);
  if (!second) return failure(second.error());
  return scans_compared(*scan, *second, stem);
}

// The scans that are asked for; without any those of the first one's campaign and sample that have ended with data.
Result<std::vector<daemon::ScanId>> repeated_scans(const JobInput& input) {
  std::vector<daemon::ScanId> ids = input.request.others;
  if (!ids.empty()) {
    ids.insert(ids.begin(), input.request.scan);
    return ids;
  }
  const auto reader = daemon::StoreReader::open(input.store_file);
  if (!reader) return failure(reader.error());
  const Result<daemon::ScanInfo> first = (*reader)->scan(input.request.scan);
  if (!first) return failure(first.error());
  for (daemon::ScanId before = 0;;) {
    const Result<std::vector<daemon::ScanInfo>> page = (*reader)->scans(before, kScansAtOnce);
    if (!page) return failure(page.error());
    for (const daemon::ScanInfo& info : *page) {
      const bool has_data = info.state == daemon::ScanState::Done || info.state == daemon::ScanState::FinishedEarly;
      if (has_data && info.campaign == first->campaign && info.sample == first->sample) ids.push_back(info.id);
    }
    if (std::ssize(*page) < kScansAtOnce) break;
    before = page->back().id;
  }
  std::ranges::sort(ids);
  return ids;
}

}  // namespace

Result<AnalysisReport> run_compare(const JobInput& input, Progress& progress) {
  progress.step(0.0, "reading the first");
  const Result<Subject> first = read_subject(input);
  if (!first) return failure(first.error());
  progress.step(0.3, "reading the other");
  const Result<Partner> partner = read_partner(input);
  if (!partner) return failure(partner.error());
  AnalysisReport report;
  report.notes = first->notes;
  if (partner->subject) {
    for (const std::string& note : partner->subject->notes) report.notes.push_back("the other: " + note);
  }
  for (std::size_t channel = 0; channel < first->brdf.channels.size(); ++channel) {
    progress.step(0.5, "comparing");
    const std::string stem =
        fmt::format("{}-against-{}{}", input.name, partner->name, channel_tail(first->brdf, channel));
    const Result<Told> told = compared_told(input, *first, *partner, channel, stem);
    if (!told) return failure(told.error());
    GONIO_TRY(take_told(*told, input, stem, channel_mark(first->brdf, channel), report));
  }
  return report;
}

Result<AnalysisReport> run_repeatability(const JobInput& input, Progress& progress) {
  progress.step(0.0, "looking for the scans");
  const Result<std::vector<daemon::ScanId>> ids = repeated_scans(input);
  if (!ids) return failure(ids.error());
  if (ids->size() < 2) {
    return failure({.code = ErrorCode::InvalidInput,
                    .device = "analysis",
                    .tried = "see how well scans repeat",
                    .seen = fmt::format("{} scan of this campaign and sample has ended with data", ids->size()),
                    .limit = "at least two"});
  }
  std::vector<Subject> subjects;
  for (const daemon::ScanId id : *ids) {
    progress.step(0.1 + 0.6 * static_cast<double>(subjects.size()) / static_cast<double>(ids->size()),
                  fmt::format("reading scan {}", id));
    Result<Subject> subject = read_stored_subject(input.store_file, id);
    if (!subject) return failure(subject.error());
    subjects.push_back(std::move(*subject));
  }
  progress.step(0.7, "comparing");
  AnalysisReport report;
  for (std::size_t k = 0; k < subjects.size(); ++k) {
    for (const std::string& note : subjects[k].notes)
      report.notes.push_back(fmt::format("scan {}: {}", (*ids)[k], note));
  }
  const MeasuredBrdf& of_first = subjects.front().brdf;
  for (std::size_t channel = 0; channel < of_first.channels.size(); ++channel) {
    std::vector<MeasuredScan> scans;
    for (const Subject& subject : subjects) {
      const Result<std::size_t> own = partner_channel(of_first, channel, subject.brdf);
      if (!own) return failure(own.error());
      const Result<MeasuredScan> scan = channel_of(subject, *own);
      if (!scan) return failure(scan.error());
      scans.push_back(*scan);
    }
    const std::string stem = input.name + "-repeatability" + channel_tail(of_first, channel);
    const Result<Told> told = repeatability_told(scans, stem);
    if (!told) return failure(told.error());
    GONIO_TRY(take_told(*told, input, stem, channel_mark(of_first, channel), report));
  }
  return report;
}

}  // namespace gonio::analysis
