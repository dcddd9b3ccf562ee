#include "daemon/analysis/subject.h"

#include "daemon/analysis/input_file.h"
#include "daemon/analysis/scan_data.h"
#include "reflectance/formats/scan_of_file.h"

namespace gonio::analysis {

Result<Subject> read_file_subject(const std::string& path) {
  Result<InputFile> file = read_input_file(path);
  if (!file) return failure(file.error());
  return Subject{.scan = std::nullopt, .brdf = std::move(file->brdf), .notes = std::move(file->notes)};
}

Result<Subject> read_stored_subject(const std::string& store_file, daemon::ScanId id) {
  const auto reader = daemon::StoreReader::open(store_file);
  if (!reader) return failure(reader.error());
  Result<StoredScan> scan = read_stored_scan(**reader, id);
  if (!scan) return failure(scan.error());
  Result<formats::MeasuredBrdf> brdf = measured_brdf(*scan);
  if (!brdf) return failure(brdf.error());
  std::vector<std::string> notes = notes_on(*scan, *brdf);
  return Subject{.scan = std::move(*scan), .brdf = std::move(*brdf), .notes = std::move(notes)};
}

Result<Subject> read_subject(const JobInput& input) {
  return input.store_file.empty() ? read_file_subject(input.input_file)
                                  : read_stored_subject(input.store_file, input.request.scan);
}

Result<reflectance::MeasuredScan> channel_of(const Subject& subject, std::size_t channel) {
  if (subject.scan) return scan_data(*subject.scan, subject.brdf, channel);
  return formats::scan_of(subject.brdf, channel);
}

std::string channel_mark(const formats::MeasuredBrdf& brdf, std::size_t channel) {
  return brdf.channels.size() == 1 ? "" : " at " + brdf.channels[channel].name;
}

std::string channel_tail(const formats::MeasuredBrdf& brdf, std::size_t channel) {
  return brdf.channels.size() == 1 ? "" : "-" + std::to_string(channel + 1);
}

}  // namespace gonio::analysis
