#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::formats {

/// What a format cannot hold, or what was done to values to make them fit. Reports name these; none is renamed.
enum class LossKind : std::uint8_t {
  Uncertainty,    ///< U and k
  SharedPart,     ///< which part of u all points share
  Sign,           ///< negative values became 0
  Flags,          ///< what a reader of a value should know
  Polarisation,   ///< of source or detector
  Wavelength,     ///< the channel's wavelength
  Channels,       ///< channels left out
  Anisotropy,     ///< averaged or read at one azimuth of incidence
  Resampled,      ///< values at the format's own directions, interpolated between the readings
  Extrapolated,   ///< of those, the ones where nothing was measured
  Precision,      ///< fewer digits
  PointsDropped,  ///< directions that the format does not admit
  Metadata,       ///< who, when, with what
};

struct Loss {
  LossKind kind = LossKind::Metadata;
  std::size_t values = 0;  ///< how many are concerned; 0 where the whole file is
  std::string what;        ///< a sentence without a full stop
  friend bool operator==(const Loss&, const Loss&) = default;
};
using Losses = std::vector<Loss>;

/// "uncertainty", "points-dropped".
[[nodiscard]] std::string_view loss_name(LossKind kind);
[[nodiscard]] bool has_loss(const Losses& losses, LossKind kind);
/// Adds the loss when any value is concerned.
void add_loss(Losses& losses, LossKind kind, std::size_t values, std::string what);

}  // namespace gonio::formats
