#include "reflectance/formats/merl_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "reflectance/convention/rusinkiewicz_angles.h"
#include "reflectance/formats/byte_io.h"

namespace gonio::formats {
namespace {

using reflectance::DirectionPair;

constexpr std::size_t kHalfNodes = 90;
constexpr std::size_t kDifferenceNodes = 90;
constexpr std::size_t kTurnNodes = 180;
constexpr std::size_t kPlane = kHalfNodes * kDifferenceNodes * kTurnNodes;
constexpr std::size_t kMerlHeader = 12;
constexpr std::size_t kMerlBytes = kMerlHeader + 3 * sizeof(double) * kPlane;
constexpr double kBelowHorizon = -1.0;
// A stored value times these is the BRDF.
constexpr std::array<double, 3> kMerlScale{1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
constexpr std::array<double, 3> kMerlWavelength{610.0, 550.0, 465.0};
constexpr std::array<const char*, 3> kMerlNames{"R", "G", "B"};

struct MerlNode {
  std::size_t half;
  std::size_t difference;
  std::size_t turn;
  [[nodiscard]] std::size_t index() const { return turn + kTurnNodes * (difference + kDifferenceNodes * half); }
};

Result<DirectionPair> directions_at(const MerlNode& node) {
  const auto n = static_cast<double>(node.half);
  return reflectance::from_rusinkiewicz({.theta_h = degrees(n * n / static_cast<double>(kHalfNodes)),
                                         .phi_h = {},
                                         .theta_d = degrees(static_cast<double>(node.difference)),
                                         .phi_d = degrees(static_cast<double>(node.turn))});
}

std::vector<double> plane_of(const ChannelSurface& channel, Losses& losses) {
  std::vector<double> plane(kPlane, kBelowHorizon);
  GridReader values(channel);
  for (std::size_t h = 0; h < kHalfNodes; ++h) {
    for (std::size_t d = 0; d < kDifferenceNodes; ++d) {
      for (std::size_t t = 0; t < kTurnNodes; ++t) {
        const MerlNode node{h, d, t};
        const Result<DirectionPair> pair = directions_at(node);
        if (pair) plane[node.index()] = values.at_least_zero(pair->i, pair->r);
      }
    }
  }
  values.add_losses(losses);
  add_anisotropy_loss(losses, channel.surface);
  return plane;
}

// For red, green and blue: an index into the channels.
std::array<std::size_t, 3> channels_for(const SurfaceFile& file) {
  std::array<std::size_t, 3> chosen{0, 0, 0};
  const std::size_t count = file.channels.size();
  if (count == 1) return chosen;
  const bool is_told =
      std::ranges::all_of(file.channels, [](const ChannelSurface& one) { return one.channel.wavelength_nm > 0.0; });
  for (std::size_t colour = 0; colour < 3; ++colour) {
    if (!is_told) {
      chosen[colour] = std::min(colour, count - 1);
      continue;
    }
    const auto nearest = std::ranges::min_element(file.channels, {}, [colour](const ChannelSurface& one) {
      return std::abs(one.channel.wavelength_nm - kMerlWavelength[colour]);
    });
    chosen[colour] = static_cast<std::size_t>(nearest - file.channels.begin());
  }
  return chosen;
}

class MerlReader {
 public:
  MerlReader(std::string_view bytes, const std::string& file, const MerlOptions& options)
      : bytes_(bytes, "MERL binary", file), options_(options) {}

  Result<MeasuredBrdf> read() {
    if (options_.step == 0) return failure(bytes_.error("step", "0", "at least 1"));
    for (const std::size_t wanted : {kHalfNodes, kDifferenceNodes, kTurnNodes}) {
      const Result<std::int32_t> dimension = bytes_.number<std::int32_t>("dimensions");
      if (!dimension) return failure(dimension.error());
      if (*dimension != static_cast<std::int32_t>(wanted))
        return failure(bytes_.error("dimensions", fmt::format("{}", *dimension), fmt::format("{}", wanted)));
    }
    const Result<std::string_view> planes = bytes_.take(kMerlBytes - kMerlHeader, "values");
    if (!planes) return failure(planes.error());
    if (bytes_.left() > 0) return failure(bytes_.error("values", fmt::format("{} bytes more", bytes_.left()), "none"));
    for (std::size_t colour = 0; colour < 3; ++colour)
      if (options_.all_channels || colour == 1) GONIO_TRY(read_plane(colour, *planes));
    brdf_.metadata.symmetry = reflectance::TableSymmetry::Isotropic;
    GONIO_TRY(check(brdf_, bytes_.file()));
    return std::move(brdf_);
  }

 private:
  Result<void> read_plane(std::size_t colour, std::string_view planes) {
    const auto channel = static_cast<std::uint32_t>(brdf_.channels.size());
    brdf_.channels.push_back({.name = kMerlNames[colour]});
    for (std::size_t h = 0; h < kHalfNodes; h += options_.step) {
      for (std::size_t d = 0; d < kDifferenceNodes; d += options_.step) {
        // Where i and r are mirrored or one, phi_d turns nothing: one point, not 180.
        const std::size_t turns = h == 0 || d == 0 ? 1 : kTurnNodes;
        for (std::size_t t = 0; t < turns; t += options_.step) {
          const MerlNode node{h, d, t};
          const std::size_t offset = sizeof(double) * (colour * kPlane + node.index());
          const auto stored = little_endian<double>(planes.data() + offset);
          if (!std::isfinite(stored))
            return failure(bytes_.error(fmt::format("value {} of {}", node.index(), kMerlNames[colour]),
                                        fmt::format("{}", stored), "a finite number"));
          if (stored >= 0.0) add_point(node, stored * kMerlScale[colour], channel);
        }
      }
    }
    return {};
  }

  void add_point(const MerlNode& node, double f, std::uint32_t channel) {
    const Result<DirectionPair> d = directions_at(node);
    if (!d) return;
    BrdfPoint point{.theta_i_deg = in_degrees(d->i.theta()),
                    .phi_i_deg = 0.0,
                    .theta_r_deg = in_degrees(d->r.theta()),
                    .phi_r_deg = plain_azimuth_deg(in_degrees(reflectance::azimuth_difference(d->i, d->r))),
                    .f_per_sr = f};
    point.channel = channel;
    brdf_.points.push_back(point);
  }

  ByteReader bytes_;
  MerlOptions options_;
  MeasuredBrdf brdf_;
};

}  // namespace

Result<Export> write_merl(const SurfaceFile& file) {
  GONIO_TRY(check(file, "MERL binary"));
  Export written{.files = {}, .losses = file.losses};
  const std::array<std::size_t, 3> chosen = channels_for(file);
  std::string bytes;
  bytes.reserve(kMerlBytes);
  for (const std::size_t dimension : {kHalfNodes, kDifferenceNodes, kTurnNodes})
    put_little_endian(bytes, static_cast<std::int32_t>(dimension));
  std::vector<double> plane;
  for (std::size_t colour = 0; colour < 3; ++colour) {
    const bool is_known = colour > 0 && chosen[colour] == chosen[colour - 1];
    if (!is_known) plane = plane_of(file.channels[chosen[colour]], written.losses);
    for (const double f : plane) put_little_endian(bytes, f < 0.0 ? f : f / kMerlScale[colour]);
  }
  const std::size_t used = std::set<std::size_t>(chosen.begin(), chosen.end()).size();
  add_loss(written.losses, LossKind::Channels, file.channels.size() - used, "the format has red, green and blue");
  add_loss(written.losses, LossKind::Wavelength, used, "the format does not say which wavelengths they are");
  written.files.push_back({.suffix = ".binary", .bytes = std::move(bytes)});
  return written;
}

Result<MeasuredBrdf> read_merl(std::string_view bytes, const std::string& file, const MerlOptions& options) {
  return MerlReader(bytes, file, options).read();
}

}  // namespace gonio::formats
