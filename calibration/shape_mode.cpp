#include "calibration/shape_mode.h"

#include <cmath>

namespace gonio::calibration {

double ShapeMode::value(const Geometry& g) const {
  const double sin_i = std::sin(g.theta_i.si());
  const double sin_r = std::sin(g.theta_r.si());
  const double dphi = g.phi_r.si() - g.phi_i.si();
  switch (kind) {
    case ShapeModeKind::Limb:
      return 0.5 * (std::pow(sin_i, 4) + std::pow(sin_r, 4));
    case ShapeModeKind::Forward:
      return -sin_i * sin_r * std::cos(dphi);
    case ShapeModeKind::Sideways:
      return sin_i * sin_i * sin_r * sin_r * std::cos(2.0 * dphi);
    case ShapeModeKind::Opposition: {
      const double x = phase_angle(g) / width;
      return std::exp(-x * x);
    }
  }
  return 0.0;
}

}  // namespace gonio::calibration
