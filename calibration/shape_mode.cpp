#include "calibration/shape_mode.h"

#include <cmath>

namespace gonio::calibration {

ShapeModePlace::ShapeModePlace(const Geometry& g)
    : geometry(g), sin_i(std::sin(g.theta_i.si())), sin_r(std::sin(g.theta_r.si())) {}

double ShapeMode::value(const ShapeModePlace& at) const {
  const double sin_i = at.sin_i;
  const double sin_r = at.sin_r;
  const double dphi = at.geometry.phi_r.si() - at.geometry.phi_i.si();
  switch (kind) {
    case ShapeModeKind::Limb:
      return 0.5 * (sin_i * sin_i * sin_i * sin_i + sin_r * sin_r * sin_r * sin_r);
    case ShapeModeKind::Forward:
      return -sin_i * sin_r * std::cos(dphi);
    case ShapeModeKind::Sideways:
      return sin_i * sin_i * sin_r * sin_r * std::cos(2.0 * dphi);
    case ShapeModeKind::Opposition: {
      const double x = phase_angle(at.geometry) / width;
      return std::exp(-x * x);
    }
  }
  return 0.0;
}

}  // namespace gonio::calibration
