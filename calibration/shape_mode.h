#pragma once

#include <cstdint>
#include <string>

#include "base/geometry.h"
#include "base/units.h"

namespace gonio::calibration {

/// The ways in which a standard's real shape may depart from its table: smooth, reciprocal, and mirror-symmetric in
/// phi.
///   Limb        (sin^4 theta_i + sin^4 theta_r) / 2: falls or rises towards grazing
///   Forward     -sin theta_i sin theta_r cos dphi: more towards specular than back
///   Sideways    sin^2 theta_i sin^2 theta_r cos 2 dphi: more in the plane of incidence than across
///   Opposition  exp(-(xi / width)^2), xi the phase angle: the hot spot
enum class ShapeModeKind : std::uint8_t { Limb, Forward, Sideways, Opposition };

/// A geometry as the modes see it: what several of them need, worked out once.
struct ShapeModePlace {
  explicit ShapeModePlace(const Geometry& g);
  Geometry geometry;
  double sin_i = 0.0;
  double sin_r = 0.0;
};

/// One angular mode with the standard deviation of its amplitude: the real shape is s (1 + a M), a ~ (0, u).
struct ShapeMode {
  std::string name;
  ShapeModeKind kind = ShapeModeKind::Limb;
  double u = 0.0;  ///< relative, k = 1
  Angle width{};   ///< of Opposition

  /// M(G), before the certificate's own geometry is taken out of it (ReferenceStandard::mode).
  [[nodiscard]] double value(const Geometry& g) const { return value(ShapeModePlace(g)); }
  [[nodiscard]] double value(const ShapeModePlace& at) const;
};

}  // namespace gonio::calibration
