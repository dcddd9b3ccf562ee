#pragma once

#include <vector>

#include "base/units.h"
#include "sim/scene/scene.h"
#include "sim/scene/truth.h"

namespace gonio::sim {

/// rho_dh(theta_i) of sample and reference as tables of one degree, linear between: within 1e-3 of the integral up to
/// 85 deg. Made at once, some 0.1 s: only for a scene that needs it. The sample must be isotropic or nearly so: it is
/// taken at phi_i = 0. Immutable; threads: any.
class ReflectedShare {
 public:
  ReflectedShare(const Scene& scene, const Truth& truth);

  /// The share of the light from theta_i (in [0, 90 deg]) that leaves the sample again.
  [[nodiscard]] double sample(Angle theta_i) const;
  [[nodiscard]] double reference(Angle theta_i) const;

 private:
  std::vector<double> sample_;
  std::vector<double> reference_;  ///< at the wavelength of the scene's first filter: what others change is below 1 %
};

}  // namespace gonio::sim
