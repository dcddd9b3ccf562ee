#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/result.h"
#include "base/units.h"
#include "calibration/certificate_mean.h"
#include "calibration/shape_mode.h"
#include "calibration/shape_table.h"

namespace gonio::calibration {

/// The certified reflectance at one wavelength; the uncertainty is already divided by the coverage factor.
struct CertificateEntry {
  Wavelength wavelength;
  double reflectance = 0.0;
  double u = 0.0;  ///< absolute, k = 1
};

struct Certificate {
  std::string date;     ///< "YYYY-MM-DD"
  std::string expires;  ///< the last day on which it holds
  CertificateGeometry geometry = CertificateGeometry::EightHemispherical;
  std::optional<Angle>
      specular_port;             ///< 8/h, h/8: half angle about the mirror direction that was left out; none: included
  double coverage_factor = 0.0;  ///< as stated, of the stated uncertainties
  Wavelength longest_gap{};      ///< interpolation goes between entries at most so far apart
  /// Of the errors of any two entries, 0 to 1: 1 is one error for all wavelengths.
  double correlation = 1.0;
  std::vector<CertificateEntry> entries;  ///< ascending, at least one
};

/// The angular shape at one wavelength.
struct SpectralShape {
  Wavelength wavelength;  ///< counts for nothing where there is no other
  ShapeTable table;
};

/// What a file reference/*.toml says, checked for form. The shape's scale is still the file's own.
struct ReferenceDefinition {
  std::string serial;
  std::string material;
  Certificate certificate;
  std::vector<SpectralShape> shapes;  ///< at least one, of one grid; ascending wavelengths
  std::vector<ShapeMode> modes;
  double u_integral = 0.0;   ///< relative, k = 1
  InputLocation expires_at;  ///< where the file says what later refusals refer to
  InputLocation entries_at;
  InputLocation shape_at;
  InputLocation shape_wavelengths_at;
};

/// Reads the text of a reference/*.toml (the format: README.md). `file` is the user's name for it.
/// Errors, each with file, line and field: InvalidInput, UnknownKey, MissingKey; ReferenceIncomplete (no coverage
/// factor, no uncertainty kind, no geometry, no specular state, no date or expiry, no u of the integral);
/// ReferenceOutOfReach (the table does not reach the certificate's own geometry).
[[nodiscard]] Result<ReferenceDefinition> parse_reference(std::string_view toml, const std::string& file);

}  // namespace gonio::calibration
