#pragma once

#include <cstddef>
#include <optional>
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

/// One error of a certificate at one wavelength, independent of the others.
struct CertificateError {
  std::optional<std::size_t> entry;  ///< of the certificate, whose own it is; none: common to all wavelengths
  double u = 0.0;                    ///< relative to the reflectance there, k = 1
};

/// The component that it is in a budget: "certificate", "certificate at 550 nm alone".
[[nodiscard]] std::string certificate_error_name(const Certificate& certificate, const CertificateError& error);

/// A calibrated white standard: what its certificate says, and how its BRDF varies with angle.
///   f_ref(G, lambda) = rho_cert(lambda) s(G) / pi
/// where s is the shape table, scaled as a whole so that the certificate's own geometry returns 1: the integral of
/// s mu_r dOmega_r / pi at theta_i = 8 deg for 8/h (theta_i and theta_r exchanged for h/8), s(0, 45 deg) for 0/45. A
/// standard is never taken for Lambertian, and never normalised per incidence: that would invent an energy balance.
/// Of tables for several wavelengths each is scaled by itself, and s is linear in wavelength between them.
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
  /// On the file's own scale; ascending wavelengths.
  [[nodiscard]] std::span<const SpectralShape> shapes() const { return definition_.shapes; }
  /// What the table of shapes()[n] is multiplied with.
  [[nodiscard]] double scale(std::size_t n) const { return scales_[n]; }
  /// The mean of mode k over the certificate's geometry, by the table of shapes()[n].
  [[nodiscard]] double mode_mean(std::size_t k, std::size_t n) const { return mode_means_[n][k]; }
  [[nodiscard]] const InputLocation& shape_location() const { return definition_.shape_at; }
  [[nodiscard]] Angle last_theta_i() const { return grid().theta_i().back(); }
  [[nodiscard]] Angle last_theta_r() const { return grid().theta_r().back(); }
  /// Relative, k = 1, of the normalising integral: the cap beyond the table, a hole at the hot spot. 0 for 0/45.
  [[nodiscard]] double u_integral() const { return definition_.u_integral; }

  /// Errors: ReferenceExpired, when `at` lies after the certificate's last day or before its first.
  [[nodiscard]] Result<void> check_date(UtcTime at) const;
  /// Whether a measurement may rest on it there. Errors: ReferenceOutOfReach (wavelength, or angles beyond the table).
  [[nodiscard]] Result<void> check_reach(Wavelength wavelength, const Geometry& g) const;

  /// Whether a geometry within reach lies beyond the table's last theta all the same, where its edge is held.
  [[nodiscard]] bool is_extrapolated(const Geometry& g) const;

  /// The certified reflectance, linear between the neighbouring entries, and its u (k = 1): the root sum of squares of
  /// certificate_errors. With a correlation of 1 between the entries u is linear too, and no interpolation makes it
  /// smaller.
  /// Errors: ReferenceOutOfReach (outside the entries, or in a gap longer than stated).
  [[nodiscard]] Result<Measured<double>> reflectance(Wavelength wavelength) const;
  /// What its error is made of: for a correlation r of the entries sqrt(r) u of each is one error, and sqrt(1 - r) u is
  /// its own. Errors: as `reflectance`.
  [[nodiscard]] Result<std::vector<CertificateError>> certificate_errors(Wavelength wavelength) const;
  /// s(G), normalised; beyond the table its edge holds (callers have asked check_reach).
  [[nodiscard]] double shape(const Geometry& g, Wavelength wavelength) const {
    return between(wavelength, [&](std::size_t n) { return scales_[n] * definition_.shapes[n].table.value(g); });
  }
  /// The rises of s about G (ShapeTable::rises); beyond the table its edge holds.
  [[nodiscard]] ShapeRises shape_rises(const Geometry& g, Wavelength wavelength, const ShapeSteps& steps) const;
  /// Standard uncertainty of s(G) between the nodes of its table, where a straight line stands in for a smooth shape.
  [[nodiscard]] double u_interpolation(const Geometry& g, Wavelength wavelength) const {
    return between(wavelength,
                   [&](std::size_t n) { return scales_[n] * definition_.shapes[n].table.interpolation_error(g); });
  }
  /// The relative change of s(G) for an amplitude 1 of mode k that keeps the certificate's reflectance: M_k(G) - <M_k>,
  /// the mean weighted with s over the certificate's geometry. One amplitude holds for all wavelengths.
  [[nodiscard]] double mode(std::size_t k, const Geometry& g, Wavelength wavelength) const {
    return mode(k, ShapeModePlace(g), wavelength);
  }
  [[nodiscard]] double mode(std::size_t k, const ShapeModePlace& at, Wavelength wavelength) const {
    return definition_.modes[k].value(at) - between(wavelength, [&](std::size_t n) { return mode_means_[n][k]; });
  }

 private:
  struct Place {
    std::size_t below = 0;
    double fraction = 0.0;  ///< of the way to the next one; 0 at the last
  };
  [[nodiscard]] const ShapeTable& grid() const { return definition_.shapes.front().table; }
  [[nodiscard]] Place place_of(Wavelength wavelength) const;
  [[nodiscard]] Result<Place> entry_place(Wavelength wavelength) const;
  [[nodiscard]] Result<void> check_shape_wavelength(Wavelength wavelength) const;
  /// `of` each table, linear in wavelength; the first and the last hold beyond them.
  template <class Of>
  [[nodiscard]] double between(Wavelength wavelength, Of of) const {
    if (definition_.shapes.size() == 1) return of(0);
    const Place place = place_of(wavelength);
    const double below = of(place.below);
    return place.fraction > 0.0 ? below + place.fraction * (of(place.below + 1) - below) : below;
  }

  ReferenceDefinition definition_;
  std::vector<double> scales_;                   ///< as many as shapes
  std::vector<std::vector<double>> mode_means_;  ///< [shape][mode]
};

}  // namespace gonio::calibration
