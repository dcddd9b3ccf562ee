#pragma once

#include <cstdint>
#include <string>

namespace gonio::formats {

enum class Polarisation : std::uint8_t { Unknown, Unpolarised, S, P };

/// What of the light a value is for: one wavelength, or a band such as R of a picture, and the polarisation of either
/// side.
struct Channel {
  std::string name;            ///< as shown: "550nm", "R"
  double wavelength_nm = 0.0;  ///< centroid; 0 for a band that has none
  Polarisation incident = Polarisation::Unknown;
  Polarisation reflected = Polarisation::Unknown;
  friend bool operator==(const Channel&, const Channel&) = default;
};

/// "550nm" from its wavelength, without trailing zeros.
[[nodiscard]] Channel channel_at(double wavelength_nm);

}  // namespace gonio::formats
