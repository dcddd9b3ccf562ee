#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "reflectance/surface/surface.h"

namespace gonio::bench {

/// A surface drawn in one figure, under the name that its files and its legend have.
struct Curve {
  std::string file;
  std::string legend;
  reflectance::Surface surface;
  bool times_cosine = false;  ///< draws f cos(theta_r), the intensity's shape, in place of f
};

/// What one figure of Mobley's notes shows: light from theta_i at phi_i = 0, the first curve as a lobe in space, all of
/// them in the plane of incidence.
struct Figure {
  std::string name;  ///< "notes-figure-8"
  std::string title;
  double theta_i_deg = 30.0;
  double most_theta_r_deg = 90.0;  ///< some models grow without end beyond
  std::vector<Curve> curves;
};

/// Those of the notes that are formulas: 3, 4 (the glitter), 6, 8. Errors: none but those of the models, whose
/// parameters are right.
[[nodiscard]] Result<std::vector<Figure>> notes_figures();

/// A value on the lobe or the cut. theta_r < 0 in a cut lies on the specular side.
struct LobePoint {
  double theta_r_deg = 0.0;
  double phi_r_deg = 0.0;
  double value_per_sr = 0.0;
};

/// One row a theta_r from the normal outwards, phi_r all around, both ends.
[[nodiscard]] std::vector<std::vector<LobePoint>> lobe(const Figure& figure, const Curve& curve);
/// theta_r from -most to most in the plane of incidence: phi_r = 0 above 0, phi_r = 180 deg below.
[[nodiscard]] std::vector<LobePoint> cut(const Figure& figure, const Curve& curve);

/// Writes FOLDER/name-curve-lobe.dat and -cut.dat (theta_r, phi_r, f, then f times the direction's x, y, z) and
/// FOLDER/name.gnuplot, which sets what lobe.gnuplot draws from. Errors: StoreFailed, with the file.
[[nodiscard]] Result<void> write_figure(const Figure& figure, const std::filesystem::path& folder);

}  // namespace gonio::bench
