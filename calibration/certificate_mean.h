#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "base/geometry.h"
#include "base/units.h"
#include "calibration/shape_table.h"

namespace gonio::calibration {

/// How a certificate's reflectance was measured: illumination / view (CIE 15).
enum class CertificateGeometry : std::uint8_t { EightHemispherical, HemisphericalEight, ZeroFortyFive };

/// What a standard with angular function `s` returns in the certificate's geometry: (1/pi) integral s mu_r dOmega_r at
/// theta_i = 8 deg for 8/h, the same over theta_i at theta_r = 8 deg for h/8, s(0, 45 deg) for 0/45.
/// Gauss-Legendre within each cell of `grid` (and of at most 5 deg), so that the kinks of an interpolated table cost
/// nothing: exact to rounding for the table itself. Directions within `port` of the mirror direction are left out
/// (a sphere with its specular port open), by a polar rule about it.
[[nodiscard]] double certificate_mean(const std::function<double(const Geometry&)>& s, const ShapeTable& grid,
                                      CertificateGeometry geometry, std::optional<Angle> port);

}  // namespace gonio::calibration
