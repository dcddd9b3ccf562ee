#include "calibration/map_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace gonio::calibration {
namespace {

constexpr std::string_view kMagic = "GONIOMAP";
constexpr std::size_t kHeader = 64;
constexpr std::uint32_t kLongestSide = 65536;

Error refusal(const std::string& name, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .device = "detector",
          .tried = fmt::format("read the map {}", name),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

template <class Word>
Word word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  Word word = 0;
  for (std::size_t k = 0; k < sizeof(Word); ++k) word |= Word{bytes[at + k]} << (8 * k);
  return word;
}

template <class Word>
void append(std::string& bytes, Word word) {
  for (std::size_t k = 0; k < sizeof(Word); ++k) bytes.push_back(static_cast<char>((word >> (8 * k)) & 0xFFU));
}

// Fowler, Noll, Vo: FNV-1a with its 64-bit constants (draft-eastlake-fnv, section 5).
std::uint64_t fnv1a(std::span<const std::uint8_t> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3;
  return hash;
}

Result<void> check_sum(std::span<const std::uint8_t> bytes, const std::string& name) {
  const auto stated = word_at<std::uint64_t>(bytes, 56);
  const std::uint64_t found = fnv1a(bytes.subspan(kHeader));
  if (stated == found) return {};
  return failure(refusal(name, fmt::format("a sum of {:016x}", found), fmt::format("{:016x}, as it states", stated)));
}

}  // namespace

Result<MapFile> parse_map_file(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.size() < kHeader || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    return failure(refusal(name, fmt::format("{} bytes that do not begin so", bytes.size()), "64 bytes from GONIOMAP"));
  }
  const auto version = word_at<std::uint32_t>(bytes, 8);
  const auto width = word_at<std::uint32_t>(bytes, 12);
  const auto height = word_at<std::uint32_t>(bytes, 16);
  const auto layers = word_at<std::uint32_t>(bytes, 20);
  const bool is_sane = version == 1 && width >= 1 && height >= 1 && width <= kLongestSide && height <= kLongestSide &&
                       layers >= 1 && layers <= MapFile::kMostLayers;
  const std::uint64_t values = std::uint64_t{width} * height;
  if (!is_sane || bytes.size() != kHeader + values * layers * sizeof(float)) {
    return failure(refusal(
        name,
        fmt::format("version {}, {} x {} pixels, {} layers, {} bytes", version, width, height, layers, bytes.size()),
        "version 1, 1 to 4 layers of float32 behind 64 bytes"));
  }
  GONIO_TRY(check_sum(bytes, name));
  MapFile map{.width = static_cast<int>(width), .height = static_cast<int>(height), .layers = {}, .u = {}};
  for (std::size_t layer = 0; layer < layers; ++layer) {
    map.u[layer] = std::bit_cast<double>(word_at<std::uint64_t>(bytes, 24 + 8 * layer));
    if (!(map.u[layer] >= 0.0) || !std::isfinite(map.u[layer])) {
      return failure(refusal(name, fmt::format("a standard uncertainty of {}", map.u[layer]), "0 or above"));
    }
    std::vector<float> pixels(static_cast<std::size_t>(values));
    const std::size_t begin = kHeader + layer * pixels.size() * sizeof(float);
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      pixels[k] = std::bit_cast<float>(word_at<std::uint32_t>(bytes, begin + k * sizeof(float)));
    }
    map.layers.push_back(std::move(pixels));
  }
  return map;
}

std::string map_file_bytes(const MapFile& map) {
  std::string values;
  for (const std::vector<float>& layer : map.layers) {
    for (const float value : layer) append(values, std::bit_cast<std::uint32_t>(value));
  }
  std::string bytes(kMagic);
  for (const int number : {1, map.width, map.height, static_cast<int>(map.layers.size())}) {
    append(bytes, static_cast<std::uint32_t>(number));
  }
  for (const double u : map.u) append(bytes, std::bit_cast<std::uint64_t>(u));
  append(bytes, fnv1a({reinterpret_cast<const std::uint8_t*>(values.data()), values.size()}));
  return bytes + values;
}

}  // namespace gonio::calibration
