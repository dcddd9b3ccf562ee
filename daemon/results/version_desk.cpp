#include "daemon/results/version_desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>

#include "base/utc_text.h"
#include "calibration/jobs/found_model.h"

namespace gonio::daemon {
namespace {

Error refused(ErrorCode code, const std::string& tried, std::string seen, std::string limit = {}) {
  return {.code = code, .device = "calibration", .tried = tried, .seen = std::move(seen), .limit = std::move(limit)};
}

Error no_such_version(CalibrationVersion version) {
  return refused(ErrorCode::NotFound, fmt::format("take calibration {}", version), "there is no such version",
                 "those of: gonioctl calibration list");
}

// Serial number of the detector that a job was run with; empty: not known.
std::string detector_of(const FoundCalibration& found) {
  const auto inputs = nlohmann::json::parse(found.inputs_json, nullptr, false);
  return inputs.is_object() ? inputs.value("detector", "") : std::string();
}

bool is_of(const FoundCalibration& found, const Instrument& instrument) {
  const std::string detector = detector_of(found);
  return detector.empty() || detector == instrument.detector.serial;
}

// A pixel's counts are bent, not their mean: what maps have straightened and averaged already cannot be undone.
Result<void> check_steps(const FoundCalibration& found, const calibration::ScanReadings& readings) {
  if (!found.found.place_of("linearity_1")) return {};
  const bool is_reduced = std::ranges::any_of(readings.readings, [](const calibration::RawReading& reading) {
    return std::ranges::any_of(reading.frames, [](const calibration::RawFrame& f) { return f.reduced.has_value(); });
  });
  if (!is_reduced) return {};
  return failure(refused(ErrorCode::IncompleteData, fmt::format("recompute with calibration {}", found.version),
                         "its step \"linearity\" acts on single pixels, and this scan's frames were reduced by the "
                         "detector's maps",
                         "the frames themselves, which were not kept"));
}

std::vector<CalibrationVersion> those_that_count(const std::vector<FoundCalibration>& all,
                                                 const Instrument& instrument) {
  std::vector<CalibrationVersion> versions;
  for (const FoundCalibration& found : all) {
    if (found.counts && changes_scans(found.job) && is_of(found, instrument)) versions.push_back(found.version);
  }
  return versions;
}

Result<void> check_asked(const FoundCalibration& found, const Instrument& instrument) {
  const std::string tried = fmt::format("take calibration {}", found.version);
  if (!changes_scans(found.job)) {
    return failure(refused(ErrorCode::InvalidInput, tried, "its job, " + found.job + ", changes no scan",
                           "gonioctl calibration show says what it found"));
  }
  if (is_of(found, instrument)) return {};
  return failure(refused(ErrorCode::InvalidInput, tried, "it was found on detector " + detector_of(found),
                         "the scan's detector, " + instrument.detector.serial));
}

}  // namespace

Result<AskedVersions> asked_versions_from(const std::string& text) {
  if (text.empty()) return AskedVersions();
  std::vector<CalibrationVersion> versions;
  if (text == "none") return AskedVersions(versions);
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    CalibrationVersion version = 0;
    const auto [rest, error] = std::from_chars(at, end, version);
    const bool ends_well = rest == end || *rest == ' ' || *rest == ',';
    if (error != std::errc() || version <= 0 || !ends_well) {
      return failure({.code = ErrorCode::InvalidInput,
                      .tried = "read the calibrations to compute with",
                      .seen = "\"" + text + "\"",
                      .limit = "version numbers as \"3 5\", or none",
                      .where = InputLocation{"", 0, "calibration"}});
    }
    versions.push_back(version);
    at = std::find_if(rest, end, [](char c) { return c != ' ' && c != ','; });
  }
  return AskedVersions(std::move(versions));
}

AskedVersions asked_versions_of(const EventRecord& event) {
  const auto data = nlohmann::json::parse(event.json, nullptr, false);
  if (!data.is_object() || !data.contains("versions") || !data["versions"].is_array()) return std::nullopt;
  return data["versions"].get<std::vector<CalibrationVersion>>();
}

bool changes_scans(const std::string& job) {
  return job != "check-standard" && job != "transfer" && job != "dark-map" && job != "flat-field" && job != "signature";
}

Result<ModelOfVersions> model_with(const std::vector<FoundCalibration>& all, const AskedVersions& asked,
                                   const Instrument& instrument, const calibration::ScanReadings& readings) {
  ModelOfVersions chosen{.model = instrument.model, .versions = {}};
  std::vector<CalibrationVersion> wanted = asked ? *asked : those_that_count(all, instrument);
  std::ranges::sort(wanted);
  std::map<std::string, CalibrationVersion> of_job;
  for (const CalibrationVersion version : wanted) {
    const auto found = std::ranges::find(all, version, &FoundCalibration::version);
    if (found == all.end()) return failure(no_such_version(version));
    GONIO_TRY(check_asked(*found, instrument));
    const auto [other, is_first] = of_job.try_emplace(found->job, version);
    if (!is_first) {
      return failure(refused(ErrorCode::InvalidInput, "compute with several calibrations",
                             fmt::format("{} and {} are both of the job {}", other->second, version, found->job),
                             "one of each job"));
    }
    GONIO_TRY(check_steps(*found, readings));
    Result<calibration::InstrumentModel> model = calibration::with_found(std::move(chosen.model), found->found);
    if (!model) return failure(model.error());
    chosen.model = std::move(*model);
    chosen.versions.push_back(version);
  }
  return chosen;
}

Result<Instrument> as_known(Instrument instrument, StoreReader& reader) {
  const Result<std::vector<FoundCalibration>> all = reader.found_calibrations();
  if (!all) return failure(all.error());
  Result<ModelOfVersions> known = model_with(*all, std::nullopt, instrument, {});
  if (!known) return failure(known.error());
  instrument.model = std::move(known->model);
  return instrument;
}

Result<FoundCalibration> found_version(StoreReader& reader, CalibrationVersion version) {
  Result<std::vector<FoundCalibration>> all = reader.found_calibrations();
  if (!all) return failure(all.error());
  const auto found = std::ranges::find(*all, version, &FoundCalibration::version);
  if (found == all->end()) return failure(no_such_version(version));
  return std::move(*found);
}

api::CalibrationReport calibration_report(const FoundCalibration& found) {
  api::CalibrationReport report{.version = found.version,
                                .job = found.job,
                                .scan = found.scan,
                                .sample = found.sample,
                                .counts = found.counts,
                                .utc = iso8601(found.at),
                                .code_version = found.code_version,
                                .note = found.found.note,
                                .covariance = found.found.covariance,
                                .inputs = found.inputs_json};
  for (std::size_t place = 0; place < found.found.values.size(); ++place) {
    const calibration::FoundValue& value = found.found.values[place];
    report.values.push_back({.name = value.name, .unit = value.unit, .value = value.value, .u = found.found.u(place)});
  }
  for (const CalibrationUse& use : found.uses) {
    report.uses.push_back({.utc = iso8601(use.at), .who = use.who, .in_use = use.in_use, .reason = use.reason});
  }
  return report;
}

}  // namespace gonio::daemon
