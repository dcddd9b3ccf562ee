#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/result.h"
#include "reflectance/integral/integral.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// rho_dh of one isotropic surface, made once and read at any incidence in some 10 ns: for those who ask for it again
/// and again, as a photon's weight or an outer integral does.
///
/// The smooth part is held as polynomials in v = sqrt(mu_i), on pieces halved until the tolerance is met at the points
/// where such an interpolant errs most; the mirror part is added exactly. Where no piece is fine enough, and always
/// closer to the horizon than mu = 1/4096 (89.986 deg), a reading falls back on the direct integral. Immutable;
/// threads: any.
class PreparedReflectance {
 public:
  /// `relative_tolerance` in [1e-12, 1e-2], of the smooth part. Costs some hundred direct integrals, each ten times as
  /// close: 0.1 s for wheat at 1e-6, seconds for a narrow lobe. After 1e8 evaluations what is left falls back. Errors:
  /// InvalidInput, for a surface that is not isotropic or a tolerance outside.
  [[nodiscard]] static Result<PreparedReflectance> make(const Surface& surface, double relative_tolerance = 1e-8);

  /// As rho_dh(surface, i, relative_tolerance) of directional_reflectance.h. `error` is the piece's own: twice what was
  /// seen where it errs most, and the errors of the integrals it was made from. `evaluations` is 0 for a value that was
  /// read.
  [[nodiscard]] Integral rho_dh(const Direction& i) const;

  [[nodiscard]] std::size_t pieces() const { return pieces_.size(); }
  /// Evaluations of f that the making took.
  [[nodiscard]] std::uint64_t evaluations() const { return evaluations_; }

 private:
  static constexpr std::size_t kCells = 1024;    ///< of v in [0, 1]
  static constexpr std::size_t kFirstCell = 16;  ///< those before it are left to the direct integral
  static constexpr std::uint16_t kDirect = 0xffff;
  static constexpr std::size_t kNodes = 10;

  /// A polynomial of t = (v - middle) per_half_width in [-1, 1].
  struct Piece {
    std::array<double, kNodes> powers{};
    double middle = 0.0;
    double per_half_width = 0.0;
    double error = 0.0;

    [[nodiscard]] double at(double v) const {
      const std::array<double, kNodes>& c = powers;
      const double t = (v - middle) * per_half_width;
      const double t2 = t * t;
      const double t4 = t2 * t2;
      const double low = (c[0] + c[1] * t) + (c[2] + c[3] * t) * t2;
      const double high = (c[4] + c[5] * t) + (c[6] + c[7] * t) * t2;
      return (low + high * t4) + (c[8] + c[9] * t) * (t4 * t4);
    }
  };
  struct Cells {
    std::size_t first;
    std::size_t count;
  };

  PreparedReflectance(const Surface& surface, double relative_tolerance);
  void prepare(Cells cells);
  [[nodiscard]] bool fits(Cells cells, Piece& piece);
  [[nodiscard]] Integral smooth_part(double v);

  Surface surface_;
  double relative_tolerance_;
  std::vector<Piece> pieces_;
  std::vector<std::uint16_t> piece_of_cell_;
  std::size_t trials_ = 0;
  std::uint64_t evaluations_ = 0;
};

}  // namespace gonio::reflectance
