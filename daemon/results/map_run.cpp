#include "daemon/results/map_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/jobs/detector_map_fit.h"
#include "daemon/config/configuration_hash.h"
#include "daemon/results/version_desk.h"

namespace gonio::daemon {
namespace {

using calibration::DetectorMapFit;

struct NamedFile {
  std::string name;  ///< its key of [detector.maps]
  std::string bytes;
};

struct MapRun {
  calibration::FoundValues found;
  std::vector<NamedFile> files;
};

Result<MapRun> run_of(StoreReader& reader, ScanId scan, const Instrument& instrument, api::CalibrationJob job) {
  const Result<PixelStacks> stacks = reader.pixel_stacks(scan);
  if (!stacks) return failure(stacks.error());
  const calibration::ApertureMask& aperture = instrument.detector.aperture;
  Result<DetectorMapFit> maps = job == api::CalibrationJob::DarkMap
                                    ? calibration::fit_dark_map(stacks->dark, aperture)
                                    : calibration::fit_flat_field(stacks->dark, stacks->lit, aperture);
  if (!maps) return failure(maps.error());
  MapRun run{.found = std::move(maps->found)};
  run.files.push_back({"dark", map_file_bytes(maps->dark)});
  run.files.push_back({"bad_pixels", map_file_bytes(maps->bad)});
  if (maps->flat) run.files.push_back({"flat", map_file_bytes(*maps->flat)});
  for (const NamedFile& file : run.files) {
    run.found.note += fmt::format("; {} SHA-256 {}", file.name, sha256_hex(file.bytes));
  }
  return run;
}

Error refusal(ErrorCode code, CalibrationVersion version, const std::string& name, std::string seen,
              std::string limit) {
  return {.code = code,
          .device = "calibration",
          .tried = fmt::format("write the map {} of calibration {}", name, version),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

std::optional<api::CalibrationJob> map_job(const std::string& name) {
  for (const auto job : {api::CalibrationJob::DarkMap, api::CalibrationJob::FlatField}) {
    if (api::calibration_job_name(job) == name) return job;
  }
  return std::nullopt;
}

}  // namespace

bool makes_maps(const std::string& job) {
  return map_job(job).has_value();
}

Result<calibration::FoundValues> map_values_of(StoreReader& reader, ScanId scan, const Instrument& instrument,
                                               api::CalibrationJob job) {
  Result<MapRun> run = run_of(reader, scan, instrument, job);
  if (!run) return failure(run.error());
  return std::move(run->found);
}

Result<std::string> map_file_of(StoreReader& reader, CalibrationVersion version, const std::string& name) {
  const Result<FoundCalibration> found = found_version(reader, version);
  if (!found) return failure(found.error());
  const auto job = map_job(found->job);
  if (!job) {
    return failure(refusal(ErrorCode::NotFound, version, name, "its job, " + found->job + ", makes no maps",
                           "a version of the job dark-map or flat-field"));
  }
  const Result<ScanTexts> texts = reader.texts(found->scan);
  if (!texts) return failure(texts.error());
  const Result<Instrument> instrument = parse_instrument(texts->instrument, "the scan's instrument.toml");
  if (!instrument) return failure(instrument.error());
  Result<MapRun> run = run_of(reader, found->scan, *instrument, *job);
  if (!run) return failure(run.error());
  const auto file = std::ranges::find(run->files, name, &NamedFile::name);
  if (file == run->files.end()) {
    return failure(refusal(ErrorCode::NotFound, version, name, "the job " + found->job + " makes none of this name",
                           "dark, bad_pixels, and of a flat-field flat"));
  }
  if (run->found == found->found) return std::move(file->bytes);
  return failure(refusal(ErrorCode::ReplayDiffers, version, name, run->found.note, found->found.note));
}

}  // namespace gonio::daemon
