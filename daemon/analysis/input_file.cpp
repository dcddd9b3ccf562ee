#include "daemon/analysis/input_file.h"

#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "base/read_file.h"

namespace gonio::analysis {

namespace {

std::string_view symmetry_text(reflectance::TableSymmetry symmetry) {
  switch (symmetry) {
    case reflectance::TableSymmetry::Isotropic:
      return "isotropic, left and right alike";
    case reflectance::TableSymmetry::Turn:
      return "the same under any turn, left and right apart";
    case reflectance::TableSymmetry::Anisotropic:
      break;
  }
  return "anisotropic";
}

// Of a CSV without the JSON that says it.
std::string taken_for_granted(const formats::MeasuredBrdf& brdf) {
  std::string channels;
  for (const formats::Channel& channel : brdf.channels)
    channels.append(channels.empty() ? "" : ", ").append(channel.name.empty() ? "one without a name" : channel.name);
  return fmt::format("no JSON beside the CSV: by its directions the sample is taken for {}; channels: {}",
                     symmetry_text(formats::symmetry_of(brdf)), channels);
}

}  // namespace

Result<InputFile> read_input_file(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return failure(bytes.error());
  std::optional<std::string> sidecar;
  const std::string beside = std::filesystem::path(path).replace_extension(".json").string();
  if (beside != path && formats::detect_format(*bytes) == formats::Format::Csv && std::filesystem::exists(beside)) {
    Result<std::string> text = read_file(beside);
    if (!text) return failure(text.error());
    sidecar = std::move(*text);
  }
  Result<formats::MeasuredBrdf> brdf = formats::read_brdf(*bytes, path, sidecar);
  if (!brdf) return failure(brdf.error());
  InputFile file{.format = *formats::detect_format(*bytes), .brdf = std::move(*brdf), .notes = {}};
  file.notes.push_back(fmt::format("read as {}", formats::format_name(file.format)));
  if (file.format == formats::Format::Csv && !sidecar) file.notes.push_back(taken_for_granted(file.brdf));
  return file;
}

}  // namespace gonio::analysis
