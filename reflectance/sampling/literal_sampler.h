#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "reflectance/sampling/direction_sample.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// Equal cells in theta over a quarter turn, and in phi over a full one.
struct LiteralCells {
  int theta = 16;  ///< 1 to 4096
  int phi = 32;    ///< 1 to 4096
};

/// Mobley (2005), appendix C, to the letter and for any surface: the BRDF as a density of phi_r and theta_r, theta
/// integrated out for the distribution of phi_r (C2, C3), then theta_r from its own distribution at the phi_r drawn
/// (C4, C5), the photon's weight times rho_dh (C1). The integrals are sums over cells, in which f is taken for constant
/// and cos(theta) sin(theta) is not. Slow, and a reference for the others; its error is that of the cells. Threads:
/// any.
class LiteralSampler {
 public:
  /// Errors: InvalidInput (`where.field` "theta" or "phi").
  [[nodiscard]] static Result<LiteralSampler> make(const Surface& surface, LiteralCells cells = {});

  /// What is the same for all photons from one direction: theta x phi evaluations to make.
  struct Incidence {
    Direction i;
    std::vector<double> share_below;  ///< [phi + 1]: of the light in the columns below each
    double rho_dh = 0.0;              ///< by the cells, mirror part included
    double specular = 0.0;
  };
  [[nodiscard]] Incidence incidence(const Direction& i) const;

  /// `theta` more evaluations. The mirror part is drawn with its share of the light. A surface that returns nothing
  /// (or, where f is negative, less) gives weight 0 towards the normal.
  [[nodiscard]] DirectionSample sample(const Incidence& incidence, UnitPoint draw) const;
  /// For one photon of any direction, all of it at once.
  [[nodiscard]] DirectionSample sample(const Direction& i, UnitPoint draw) const { return sample(incidence(i), draw); }

  /// By how much rho_dh of the cells differs from the integral's (directional_reflectance.h), relative. The density
  /// drawn from is off by more: by as much as f varies within a cell.
  [[nodiscard]] double rho_dh_error(const Direction& i) const;

 private:
  LiteralSampler(const Surface& surface, LiteralCells cells);
  [[nodiscard]] double column(const Direction& i, Angle phi, std::vector<double>& below) const;

  Surface surface_;
  LiteralCells cells_;
  std::vector<Angle> theta_;        ///< middles of the cells
  std::vector<double> sin2_edges_;  ///< sin^2 of their edges
};

}  // namespace gonio::reflectance
