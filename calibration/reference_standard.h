#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/clock.h"
#include "base/geometry.h"
#include "base/result.h"
#include "base/units.h"
#include "calibration/reference_definition.h"

namespace gonio::calibration {

/// A calibrated white standard: what its certificate says, and how its BRDF varies with angle.
///   f_ref(G, lambda) = rho_cert(lambda) s(G) / pi
/// where s is the shape table, scaled as a whole so that the certificate's own geometry returns 1: the integral of
/// s mu_r dOmega_r / pi at theta_i = 8 deg for 8/h (theta_i and theta_r exchanged for h/8), s(0, 45 deg) for 0/45. A
/// standard is never taken for Lambertian, and never normalised per incidence: that would invent an energy balance.
/// An immutable value; threads: any.
class ReferenceStandard {
 public:
  explicit ReferenceStandard(ReferenceDefinition definition);
  /// Errors: as parse_reference.
  [[nodiscard]] static Result<ReferenceStandard> parse(std::string_view toml, const std::string& file);

  [[nodiscard]] const std::string& serial() const { return definition_.serial; }
  [[nodiscard]] const std::string& material() const { return definition_.material; }
  [[nodiscard]] const Certificate& certificate() const { return definition_.certificate; }
  [[nodiscard]] std::span<const ShapeMode> modes() const { return definition_.modes; }
  [[nodiscard]] const ShapeTable& table() const { return definition_.shape; }  ///< on the file's own scale
  [[nodiscard]] Angle last_theta_i() const { return definition_.shape.theta_i().back(); }
  [[nodiscard]] Angle last_theta_r() const { return definition_.shape.theta_r().back(); }
  /// Relative, k = 1, of the normalising integral: the cap beyond the table, a hole at the hot spot. 0 for 0/45.
  [[nodiscard]] double u_integral() const { return definition_.u_integral; }

  /// Errors: ReferenceExpired, when `at` lies after the certificate's last day or before its first.
  [[nodiscard]] Result<void> check_date(UtcTime at) const;
  /// Whether a measurement may rest on it there. Errors: ReferenceOutOfReach (wavelength, or angles beyond the table).
  [[nodiscard]] Result<void> check_reach(Wavelength wavelength, const Geometry& g) const;

  /// The certified reflectance and its u (k = 1), both linear between the neighbouring entries: their errors are taken
  /// for one error, so that no interpolation makes them smaller.
  /// Errors: ReferenceOutOfReach (outside the entries, or in a gap longer than stated).
  [[nodiscard]] Result<Measured<double>> reflectance(Wavelength wavelength) const;
  /// s(G), normalised; beyond the table its edge holds (callers have asked check_reach).
  [[nodiscard]] double shape(const Geometry& g) const { return scale_ * definition_.shape.value(g); }
  /// Standard uncertainty of s(G) between the nodes of its table, where a straight line stands in for a smooth shape.
  [[nodiscard]] double u_interpolation(const Geometry& g) const {
    return scale_ * definition_.shape.interpolation_error(g);
  }
  /// The relative change of s(G) for an amplitude 1 of mode k that keeps the certificate's reflectance: M_k(G) - <M_k>,
  /// the mean weighted with s over the certificate's geometry.
  [[nodiscard]] double mode(std::size_t k, const Geometry& g) const {
    return definition_.modes[k].value(g) - mode_means_[k];
  }

 private:
  ReferenceDefinition definition_;
  double scale_ = 1.0;
  std::vector<double> mode_means_;
};

}  // namespace gonio::calibration
