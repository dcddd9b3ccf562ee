#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/analysis/job.h"
#include "daemon/analysis/stored_scan.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/measured/measured_scan.h"

namespace gonio::analysis {

/// What a job works on: a stored scan, or a file.
struct Subject {
  std::optional<StoredScan> scan;
  formats::MeasuredBrdf brdf;
  std::vector<std::string> notes;
};

/// The job's scan, or its input file where it has no store. Errors: of the store, of the file's reader; InvalidInput
/// for a scan without a value.
[[nodiscard]] Result<Subject> read_subject(const JobInput& input);
[[nodiscard]] Result<Subject> read_stored_subject(const std::string& store_file, daemon::ScanId scan);
[[nodiscard]] Result<Subject> read_file_subject(const std::string& file);

/// One channel as data. Errors: InvalidInput.
[[nodiscard]] Result<reflectance::MeasuredScan> channel_of(const Subject& subject, std::size_t channel);
/// " at 550nm", or nothing where there is one channel only: for the names of facts.
[[nodiscard]] std::string channel_mark(const formats::MeasuredBrdf& brdf, std::size_t channel);
/// "-2" of the second of several channels: for the names of files.
[[nodiscard]] std::string channel_tail(const formats::MeasuredBrdf& brdf, std::size_t channel);

}  // namespace gonio::analysis
