#pragma once

#include <optional>

#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// A surface that has lost its mirror part, and nothing else: whatever its model offers, this one does. Not for a sum,
/// which is taken term by term.
struct SmoothPart {
  Surface surface;

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const { return surface.eval(i, r); }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f) const { surface.eval_fast(i, r, f); }
  [[nodiscard]] FastPath fast_path() const { return surface.fast_path(); }
  [[nodiscard]] std::optional<double> rho_dh(const Direction& i) const { return surface.closed_rho_dh(i); }
  [[nodiscard]] std::optional<Integral> rho_dh(const Direction& i, double relative_tolerance) const {
    return surface.own_rho_dh(i, relative_tolerance);
  }
  [[nodiscard]] std::string_view model() const { return surface.model(); }
  [[nodiscard]] Parameters parameters() const { return surface.parameters(); }
  [[nodiscard]] bool is_isotropic() const { return surface.is_isotropic(); }
  [[nodiscard]] Feature feature() const { return surface.feature(); }
};

}  // namespace gonio::reflectance
