#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/error.h"
#include "base/units.h"

namespace gonio::api {

/// The product of the part's theta_i and phi_i with these, theta_r slower.
struct ProductShape {
  std::vector<Angle> theta_r;
  std::vector<Angle> phi_r;
};

/// One line of a list of points.
struct ListedPoint {
  Angle theta_i;
  Angle phi_i;
  Angle theta_r;
  Angle phi_r;
  std::optional<Wavelength> wavelength;  ///< none: each of the part's
  int line = 0;
};
/// points = "file.csv": each line a point, as written.
struct ListShape {
  std::string file;
  std::vector<ListedPoint> points;
};

/// rings = {gauss = N, around = M}: N rings at the nodes of Gauss and Legendre in cos^2(theta_r), each with M azimuths
/// half a step off the plane of incidence. `gauss_rings` (daemon/planner) gives nodes and weights.
struct RingsShape {
  int rings = 0;
  int around = 0;
  bool is_half = false;     ///< the azimuths in (0, 180 deg) only: a sample that is its own mirror image
  std::optional<Angle> to;  ///< none: as far as the arm reaches
};

/// Rings of directions about a peak, fine near it: the spacing grows in proportion to the distance from it, from
/// `finest` at the peak to `coarsest` at `half_angle`. What the arms do not reach is left out.
struct ConeShape {
  enum class About : std::uint8_t { Specular, Retro, Direction };
  About about = About::Specular;
  Angle theta;  ///< of `Direction`
  Angle phi;
  Angle half_angle;
  Angle finest;
  Angle coarsest;
};

/// All of a range of directions, even in solid angle: rows of theta_r, in each as many phi_r as `spacing` of arc asks
/// for.
struct BoxShape {
  Angle theta_low;
  Angle theta_high;
  Angle phi_low;
  Angle phi_high;
  Angle spacing;
};

/// A block of points of a plan. All its shapes but the list take the part's theta_i, phi_i and wavelengths.
struct PlanPart {
  InputLocation where;  ///< in the plan; its field is "geometry" or "geometry.parts"
  std::vector<Angle> theta_i;
  std::vector<Angle> phi_i;
  std::vector<Wavelength> wavelengths;
  int repeats = 1;  ///< each point is measured so many times, as points of their own
  std::variant<ProductShape, ListShape, RingsShape, ConeShape, BoxShape> shape;
};

}  // namespace gonio::api
