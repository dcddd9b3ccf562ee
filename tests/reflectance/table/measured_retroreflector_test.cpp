// A yellow retro-reflecting sheet, measured at three incidences by 7397 directions; the data are not part of the
// project. Looked for in $GONIO_SHARED_DATA, else beside the source tree.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/table/cross_validation.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {
namespace {

std::filesystem::path data_folder() {
  if (const char* named = std::getenv("GONIO_SHARED_DATA")) return named;
  return std::filesystem::path(GONIO_SOURCE_DIR) / "../shared/data";
}

// ALTA text: lines of theta_i, theta_r cos(dphi), theta_r sin(dphi) [rad] and BRDF times cos(theta_r) [sr^-1]; '#'
// opens a line of the header. Beyond 89 deg the cosine leaves nothing to divide by.
std::optional<std::vector<TableReading>> retro_readings() {
  std::ifstream file(data_folder() / "measured/retro-3m-yellow.alta");
  if (!file) return std::nullopt;
  std::vector<TableReading> readings;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    double theta_i = 0.0;
    double x = 0.0;
    double y = 0.0;
    double f_cos = 0.0;
    fields >> theta_i >> x >> y >> f_cos;
    const double theta_r = std::hypot(x, y);
    if (theta_r > degrees(89.0).si()) continue;
    readings.push_back({.geometry = {.theta_i = radians(theta_i),
                                     .phi_i = {},
                                     .theta_r = radians(theta_r),
                                     .phi_r = radians(std::atan2(y, x))},
                        .f = {.value = per_steradian(f_cos / std::cos(theta_r))}});
  }
  return readings;
}

TEST(MeasuredRetroreflector, KeepsItsHotSpotAndItsEnergy) {
  const std::optional<std::vector<TableReading>> readings = retro_readings();
  if (!readings) {
    std::cout << "no measured data in " << data_folder() << ": nothing checked\n";
    return;
  }
  ASSERT_GT(readings->size(), 7000u);
  const TabulatedSurface t = TabulatedSurface::make(*readings, {.symmetry = TableSymmetry::Turn}).value();
  EXPECT_EQ(t.report().incidences, 3u);
  EXPECT_TRUE(t.options().both_features) << "a glossy sheet over the retro-reflector";

  // Read where it was read.
  for (std::size_t k = 0; k < readings->size(); k += 7) {
    const TableReading& reading = (*readings)[k];
    const Brdf f = t.eval(incident_direction(reading.geometry), reflected_direction(reading.geometry));
    EXPECT_NEAR(f / reading.f.value, 1.0, 1e-4) << "reading " << k;
  }
  for (const double theta : {15.0, 20.0, 30.0, 45.0, 60.0}) {
    const Direction i = Direction::from_angles(degrees(theta), Angle{});
    // Retro-reflection stays at retro-reflection between the incidences, and is 8 to 14 per sr at all three.
    EXPECT_GT(in_per_steradian(t.eval(i, i)), 7.0) << theta;
    EXPECT_LT(in_per_steradian(t.eval(i, i)), 20.0) << theta;
    // The gloss is at the mirror direction, once: not where the neighbours have theirs.
    EXPECT_GT(in_per_steradian(t.eval(i, mirrored(i))), 7.0) << theta;
    for (const double ghost : {15.0, 30.0, 60.0}) {
      if (std::abs(ghost - theta) < 10.0) continue;
      EXPECT_LT(in_per_steradian(t.eval(i, Direction::from_angles(degrees(ghost), degrees(180.0)))), 1.0) << theta;
    }
    const Integral rho = rho_dh(t, i, 1e-3);
    EXPECT_GT(rho.value, 0.4) << theta;
    EXPECT_LT(rho.value, 1.0) << theta;
    EXPECT_LE(rho.error, 1e-3 * rho.value) << theta;
    for (double theta_r = 0.0; theta_r < 89.0; theta_r += 3.1) {
      for (double phi = -180.0; phi < 180.0; phi += 11.0) {
        EXPECT_GT(in_per_steradian(t.eval(i, Direction::from_angles(degrees(theta_r), degrees(phi)))), 0.0);
      }
    }
  }
  EXPECT_LT(t.extrapolated_share(Direction::from_angles(degrees(30.0), Angle{})), 0.01);

  const CrossValidation views = cross_validate_views(t);
  EXPECT_GT(views.count, 7000u);
  EXPECT_LT(views.rms / views.mean, 0.2);
  std::cout << "leaving one out: rms " << views.rms.si() << " /sr, most " << views.most.si() << ", mean |f| "
            << views.mean.si() << '\n';
}

}  // namespace
}  // namespace gonio::reflectance
