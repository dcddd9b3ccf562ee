// Directions, Fresnel's formulas and every model at arguments of our own choice, the hard ones among them, against
// textbook formulas of 30 to 120 digits (oracle.py).
#include <gtest/gtest.h>

#include <vector>

#include "reflectance/surface/fresnel.h"
#include "tests/reflectance/contract/oracle.h"
#include "tests/reflectance/contract/tolerance.h"

namespace gonio::reflectance {
namespace {

struct SeparationRow {
  OracleDirection i;
  OracleDirection r;
  double phase_angle;
  double sin2_half;
  double cos2_half;
  double cos_phase;
  double retro_distance;
};

const SeparationRow kSeparations[] = {
#include "tests/reflectance/contract/oracle_separations.inc"
};

TEST(OraclePoints, AnglesBetweenDirections) {
  for (const SeparationRow& row : kSeparations) {
    SCOPED_TRACE(::testing::Message() << row.i << ", " << row.r);
    const Direction i = row.i.direction();
    const Direction r = row.r.direction();

    EXPECT_TRUE(is_within(phase_angle(i, r).si(), row.phase_angle, 1e-14));
    EXPECT_TRUE(is_within(sin2_half_phase(i, r), row.sin2_half, 1e-14));
    EXPECT_TRUE(is_within(cos2_half_phase(i, r), row.cos2_half, 1e-14));
    EXPECT_NEAR(cos_phase(i, r), row.cos_phase, 4e-16);
    EXPECT_TRUE(is_within(retro_distance(i, r), row.retro_distance, 1e-14));
  }
}

struct FresnelRow {
  double theta;
  double n;
  double s;
  double p;
  double unpolarised;
  double through;
  double condition;
  double through_condition;
};

const FresnelRow kFresnel[] = {
#include "tests/reflectance/contract/oracle_fresnel.inc"
};

TEST(OraclePoints, Fresnel) {
  for (const FresnelRow& row : kFresnel) {
    SCOPED_TRACE(::testing::Message() << "theta " << row.theta << " rad, n " << row.n);
    const FresnelReflectance ours = fresnel(radians(row.theta), row.n);

    const double tolerance = point_tolerance(row.condition);
    EXPECT_TRUE(is_within(ours.unpolarised(), row.unpolarised, tolerance));
    EXPECT_NEAR(ours.s, row.s, tolerance);
    EXPECT_NEAR(ours.p, row.p, tolerance);
    const Direction i = Direction::from_angles(radians(row.theta), {});
    EXPECT_TRUE(is_within(fresnel_transmittance(i.mu(), i.sin_theta(), row.n), row.through,
                          point_tolerance(row.through_condition)));
  }
}

struct PointRow {
  std::size_t surface;
  OracleDirection i;
  OracleDirection r;
  double f;
  double condition;
};

const PointRow kPoints[] = {
#include "tests/reflectance/contract/oracle_points.inc"
};

TEST(OraclePoints, EveryModel) {
  std::vector<Surface> surfaces;
  for (const OracleSurface& s : kOracleSurfaces) surfaces.push_back(s.surface());

  for (const PointRow& row : kPoints) {
    const double f = surfaces[row.surface].eval(row.i.direction(), row.r.direction()).si();
    EXPECT_TRUE(is_within(f, row.f, point_tolerance(row.condition)))
        << kOracleSurfaces[row.surface] << ": " << row.i << ", " << row.r;
  }
}

}  // namespace
}  // namespace gonio::reflectance
