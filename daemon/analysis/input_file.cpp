#include "daemon/analysis/input_file.h"

#include <filesystem>
#include <optional>

#include "base/read_file.h"

namespace gonio::analysis {

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
  return InputFile{.format = *formats::detect_format(*bytes), .brdf = std::move(*brdf)};
}

}  // namespace gonio::analysis
