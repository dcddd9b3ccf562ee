#include "daemon/config/detector_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "base/read_file.h"
#include "base/toml_reader.h"
#include "calibration/map_file.h"
#include "daemon/config/configuration_hash.h"

namespace gonio::daemon {
namespace {

using calibration::MapFile;

constexpr double kLongestTime_s = 3600.0;
constexpr std::array<std::string_view, 9> kPixelFormats{"Mono8",        "Mono10",       "Mono12",  "Mono14", "Mono16",
                                                        "Mono10Packed", "Mono12Packed", "Mono10p", "Mono12p"};

calibration::ApertureMask read_aperture(TomlReader table, const DetectorConfig& detector) {
  calibration::ApertureMask mask;
  mask.centre_x_px = table.number("centre_x_px", {.least = 0.0, .most = detector.width_px - 1.0, .unit = "px"});
  mask.centre_y_px = table.number("centre_y_px", {.least = 0.0, .most = detector.height_px - 1.0, .unit = "px"});
  // The whole circle must lie on the sensor: a cut one would not see what the certificate's spot was.
  const double reach = std::min(std::min(mask.centre_x_px, detector.width_px - 1.0 - mask.centre_x_px),
                                std::min(mask.centre_y_px, detector.height_px - 1.0 - mask.centre_y_px));
  mask.radius_px = table.number("radius_px", {.least = 1.0, .most = std::max(1.0, reach), .unit = "px"});
  return mask;
}

void read_region(TomlReader& table, DetectorConfig& detector) {
  constexpr int kLongestSide = 16384;
  detector.width_px = static_cast<int>(table.integer("width_px", 4, kLongestSide));
  detector.height_px = static_cast<int>(table.integer("height_px", 4, kLongestSide));
  auto region = table.optional_table("region");
  if (!region) return;
  detector.offset_x_px = static_cast<int>(region->integer("offset_x_px", 0, kLongestSide));
  detector.offset_y_px = static_cast<int>(region->integer("offset_y_px", 0, kLongestSide));
}

DetectorMapFiles read_map_files(TomlReader& table) {
  auto maps = table.optional_table("maps");
  if (!maps) return {};
  return {.dark = maps->text_or("dark", ""),
          .flat = maps->text_or("flat", ""),
          .bad_pixels = maps->text_or("bad_pixels", ""),
          .linearity = maps->text_or("linearity", "")};
}

/// Collects the maps of one detector, and the bytes that they came in.
class MapLoader {
 public:
  MapLoader(const DetectorConfig& detector, std::filesystem::path directory)
      : detector_(detector), directory_(std::move(directory)) {}

  /// A map of one to `most_layers` layers; empty layers when there is no such file.
  Result<MapFile> load(const std::string& file, std::size_t most_layers) {
    if (file.empty()) return MapFile{};
    const std::string path = (directory_ / file).string();
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return failure(bytes.error());
    hashed_ += fmt::format("{} bytes\n", bytes->size()) + *bytes;
    auto map = calibration::parse_map_file({reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()}, path);
    if (!map) return map;
    if (map->width == detector_.width_px && map->height == detector_.height_px && map->layers.size() <= most_layers)
      return map;
    return failure(
        refusal(ErrorCode::InvalidInput, path,
                fmt::format("{} x {} pixels, {} layers", map->width, map->height, map->layers.size()),
                fmt::format("{} x {}, at most {} layers", detector_.width_px, detector_.height_px, most_layers)));
  }

  [[nodiscard]] std::string version() const { return sha256_hex(hashed_); }

 private:
  static Error refusal(ErrorCode code, const std::string& path, std::string seen, std::string limit) {
    return {.code = code,
            .device = "detector",
            .tried = fmt::format("read the map {}", path),
            .seen = std::move(seen),
            .limit = std::move(limit)};
  }

  const DetectorConfig& detector_;
  std::filesystem::path directory_;
  std::string hashed_;
};

std::vector<float> layer(const MapFile& map, std::size_t index) {
  return index < map.layers.size() ? map.layers[index] : std::vector<float>();
}

}  // namespace

DetectorConfig read_detector(TomlReader& table) {
  constexpr std::array<std::string_view, 2> kLinks{"gige", "usb3"};  // in the order of CameraLinkKind
  DetectorConfig detector;
  detector.link = static_cast<CameraLinkKind>(table.choice_or("link", 0, kLinks));
  detector.address = table.text_or("address", "");
  detector.serial = table.text("serial");
  read_region(table, detector);
  detector.pixel_format = kPixelFormats[table.choice("pixel_format", kPixelFormats)];
  if (detector.link == CameraLinkKind::Gige)
    detector.packet_size_bytes = static_cast<int>(table.integer("packet_size_bytes", 576, 9000));
  const NumberRange some_time{.least = 1e-6, .most = kLongestTime_s, .unit = "s"};
  const double shortest = table.number("shortest_exposure_s", some_time);
  detector.shortest_exposure = seconds(shortest);
  detector.longest_exposure =
      seconds(table.number("longest_exposure_s", {.least = shortest, .most = kLongestTime_s, .unit = "s"}));
  detector.gain_db = table.number("gain_db", {.least = 0.0, .most = 60.0, .unit = "dB"});
  detector.frames_at_most = static_cast<int>(table.integer("frames_at_most", 1, 100000));
  detector.aperture = read_aperture(table.table("aperture"), detector);
  detector.map_files = read_map_files(table);
  return detector;
}

Result<std::shared_ptr<const calibration::DetectorMaps>> load_detector_maps(const DetectorConfig& detector,
                                                                            const std::string& directory) {
  MapLoader loader(detector, directory);
  const auto dark = loader.load(detector.map_files.dark, 2);
  if (!dark) return failure(dark.error());
  const auto flat = loader.load(detector.map_files.flat, 1);
  if (!flat) return failure(flat.error());
  const auto bad = loader.load(detector.map_files.bad_pixels, 1);
  if (!bad) return failure(bad.error());
  const auto linearity = loader.load(detector.map_files.linearity, 2);
  if (!linearity) return failure(linearity.error());
  auto maps = std::make_shared<calibration::DetectorMaps>();
  maps->width = detector.width_px;
  maps->height = detector.height_px;
  maps->dark_offset_dn = layer(*dark, 0);
  maps->dark_rate_dn_per_s = layer(*dark, 1);
  maps->flat = layer(*flat, 0);
  maps->linearity_1 = layer(*linearity, 0);
  maps->linearity_2 = layer(*linearity, 1);
  for (const float value : layer(*bad, 0)) maps->bad.push_back(value == 0.0F ? 0 : 1);
  maps->u_dark_offset_dn = dark->u[0];
  maps->u_dark_rate_dn_per_s = dark->u[1];
  maps->u_flat = flat->u[0];
  maps->version = loader.version();
  return std::shared_ptr<const calibration::DetectorMaps>(std::move(maps));
}

}  // namespace gonio::daemon
