#include "daemon/analysis/drawn_surfaces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectance/table/tabulated_surface.h"

namespace gonio::analysis {
namespace {

using reflectance::Direction;
using reflectance::TabulatedSurface;

constexpr double kNowhere = -1.0;

// Lit from 30 deg at phi = 0, views to 75 deg; none within `gap_deg` of (45, 90).
formats::MeasuredBrdf grid(double theta_step, double phi_step, double gap_deg = kNowhere) {
  formats::MeasuredBrdf brdf;
  brdf.channels = {formats::channel_at(550.0)};
  const auto middle = Direction::from_angles(degrees(45.0), degrees(90.0)).vector();
  for (double theta = 0.0; theta <= 75.0; theta += theta_step) {
    for (double phi = 0.0; phi < (theta > 0.0 ? 360.0 : 1.0); phi += phi_step) {
      const auto r = Direction::from_angles(degrees(theta), degrees(phi)).vector();
      const double off = std::acos(std::min(1.0, r.x * middle.x + r.y * middle.y + r.z * middle.z));
      if (in_degrees(radians(off)) < gap_deg) continue;
      brdf.points.push_back({.theta_i_deg = 30.0, .theta_r_deg = theta, .phi_r_deg = phi, .f_per_sr = 0.1});
    }
  }
  return brdf;
}

bool is_drawn(const Result<formats::SurfaceFile>& surfaces, double theta_deg, double phi_deg) {
  const auto* table = surfaces.value().channels.at(0).surface.as<TabulatedSurface>();
  return table->covers(Direction::from_angles(degrees(30.0), Angle{}),
                       Direction::from_angles(degrees(theta_deg), degrees(phi_deg)));
}

TEST(DrawnSurfaces, OfACoarseGridReachAsFarAsItsReadings) {
  const formats::MeasuredBrdf coarse = grid(15.0, 30.0);
  ASSERT_FALSE(is_drawn(formats::surfaces_of(coarse), 65.0, 15.0)) << "its cells there are wider than 25 deg";

  const auto drawn = drawn_surfaces(coarse);

  for (double theta = 1.0; theta < 71.0; theta += 2.0) {
    for (double phi = 3.0; phi < 360.0; phi += 7.0) EXPECT_TRUE(is_drawn(drawn, theta, phi)) << theta << " " << phi;
  }
  EXPECT_FALSE(is_drawn(drawn, 80.0, 0.0)) << "beyond the readings";
}

TEST(DrawnSurfaces, LeaveAHoleWhiteThatIsWiderThanTheGridsOwnCells) {
  EXPECT_TRUE(is_drawn(drawn_surfaces(grid(5.0, 10.0)), 45.0, 90.0));
  EXPECT_FALSE(is_drawn(drawn_surfaces(grid(5.0, 10.0, 15.0)), 45.0, 90.0));
  EXPECT_FALSE(is_drawn(drawn_surfaces(grid(15.0, 30.0, 35.0)), 45.0, 90.0));
}

}  // namespace
}  // namespace gonio::analysis
