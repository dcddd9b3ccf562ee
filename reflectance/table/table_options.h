#pragma once

#include <cstdint>
#include <optional>

#include "base/units.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// What a turn of the sample, or a look into a mirror, does to the surface.
enum class TableSymmetry : std::uint8_t {
  Isotropic,    ///< only |phi_r - phi_i| counts: left and right readings tell of the same value
  Turn,         ///< only phi_r - phi_i counts, over 360 deg: left and right differ
  Anisotropic,  ///< phi_i counts too
};

/// How the viewing directions of an incidence lie.
enum class TableLayout : std::uint8_t {
  Scattered,  ///< anyhow: triangles between them
  Rings,      ///< on rings of common theta_r, each with azimuths of its own: bilinear in theta_r and phi
};

/// What stands where nothing was measured; `covers` tells of it in any case.
enum class BeyondReach : std::uint8_t {
  Hold,      ///< the value of the nearest place within reach
  Continue,  ///< that value, changed as a smooth fit to the outer readings changes from there
};

struct TableOptions {
  TableSymmetry symmetry = TableSymmetry::Isotropic;
  TableLayout layout = TableLayout::Scattered;
  BeyondReach beyond = BeyondReach::Hold;
  /// What moves with the incidence, so that between two of them it stands between, once; found in the readings when
  /// absent.
  std::optional<Feature> feature = std::nullopt;
  /// The other one of hot spot and lobe moves too, each view with the one that it is closer to; found in the readings
  /// when `feature` is absent.
  bool both_features = false;
  /// f(i, r) and f(r, i) are made one: each counts by its closeness to readings.
  bool reciprocal = false;
  /// Directions closer than this are one: encoders do not repeat to the last digit. 1e-4 to 5 deg.
  Angle same_direction = degrees(0.01);
  /// A cell between readings that is wider than this is a hole (the detector's shadow, a skipped point). Up to 180 deg.
  Angle widest_cell = degrees(25.0);
  /// Between incidences farther apart than this, in theta or along phi_i, nothing counts as measured. Up to 180 deg.
  Angle widest_incidence_step = degrees(45.0);
};

}  // namespace gonio::reflectance
