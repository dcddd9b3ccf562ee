#include "sim/scene/read_surface_file.h"

#include <filesystem>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/read_file.h"
#include "reflectance/formats/format.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::sim {
namespace {

Result<reflectance::Surface> channel_of(const formats::SurfaceFile& file, const std::string& path,
                                        const std::string& channel) {
  std::string names;
  for (const formats::ChannelSurface& c : file.channels) {
    if (c.channel.name == channel || (channel.empty() && file.channels.size() == 1)) return c.surface;
    names += (names.empty() ? "" : ", ") + c.channel.name;
  }
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "read the sample's surface from " + path,
                  .seen = channel.empty() ? fmt::format("{} channels", file.channels.size())
                                          : fmt::format("there is no channel \"{}\"", channel),
                  .limit = "channel, one of " + names,
                  .where = InputLocation{.file = path, .field = "channel"}});
}

}  // namespace

Result<reflectance::Surface> surface_of_file(const std::string& path, const std::string& channel) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return failure(bytes.error());
  const Result<std::string> sidecar = read_file(std::filesystem::path(path).replace_extension(".json").string());
  const bool is_csv = formats::detect_format(*bytes) == formats::Format::Csv;
  const auto beside = is_csv && sidecar ? std::optional<std::string_view>(*sidecar) : std::nullopt;
  const Result<formats::MeasuredBrdf> brdf = formats::read_brdf(*bytes, path, beside);
  if (!brdf) return failure(brdf.error());
  const Result<formats::SurfaceFile> file = formats::surfaces_of(*brdf);
  if (!file) return failure(file.error());
  return channel_of(*file, path, channel);
}

}  // namespace gonio::sim
