#pragma once

#include <string>
#include <vector>

#include "base/units.h"

namespace gonio::sim {

struct CertificateEntry {
  Wavelength wavelength;
  double reflectance = 0.0;
  double uncertainty = 0.0;  ///< absolute, at the certificate's coverage factor
};

/// The ways in which a shape may be wrong; M(G), symmetric in i <-> r:
///   Limb        (sin^4 theta_i + sin^4 theta_r) / 2
///   Forward     -sin theta_i sin theta_r cos dphi
///   Sideways    sin^2 theta_i sin^2 theta_r cos 2 dphi
///   Opposition  exp(-(xi / width)^2), xi the phase angle
enum class ModeKind : unsigned char { Limb, Forward, Sideways, Opposition };

struct ShapeMode {
  ModeKind kind = ModeKind::Limb;
  double u = 0.0;  ///< relative standard deviation of its amplitude
  Angle width;     ///< of Opposition only
};

/// The reference standard as its papers describe it: an 8/h certificate, specular included, and the angular shape of
/// `SpectralonShape` with modes.
struct ReferenceSpec {
  std::string serial = "SRT-99-020";
  std::string material = "Spectralon 99 %";
  std::string certificate_date = "2025-11-03";
  std::string expires = "2099-12-31";
  double coverage_factor = 2.0;
  std::vector<CertificateEntry> certificate;  ///< ascending wavelengths
  double u_integral = 0.0;                    ///< relative, of the shape's integral
  std::vector<ShapeMode> modes;
};

}  // namespace gonio::sim
