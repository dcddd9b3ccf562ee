#include "reflectance/formats/scan_of_file.h"

#include <gtest/gtest.h>

#include <iostream>

#include "reflectance/formats/format.h"
#include "reflectance/measured/interpolate_scan.h"
#include "reflectance/measured/scan_quantities.h"
#include "tests/reflectance/formats/shared_data.h"

namespace gonio::formats {
namespace {

MeasuredBrdf two_channels() {
  MeasuredBrdf brdf;
  brdf.metadata.sample = "tile";
  brdf.metadata.references = {"SRT-99-020"};
  brdf.channels = {channel_at(450.0), channel_at(550.0)};
  brdf.flag_names = {"near-zero", "drifted"};
  for (std::uint32_t k = 0; k < 6; ++k) {
    brdf.points.push_back({.theta_i_deg = 10.0,
                           .theta_r_deg = -10.0 * k,
                           .f_per_sr = 0.1 * k,
                           .U_per_sr = 0.1,
                           .k = 2.0,
                           .u_shared_per_sr = 0.03,
                           .channel = k % 2,
                           .flags = k == 5 ? 2U : 0U});
  }
  return brdf;
}

TEST(ScanOfFile, SplitsTheUncertaintyAsTheFileTellsIt) {
  const reflectance::MeasuredScan scan = scan_of(two_channels(), 1).value();

  ASSERT_EQ(scan.points.size(), 6U);
  EXPECT_NEAR(scan.points[1].u_random.si(), 0.04, 1e-15);
  EXPECT_NEAR(scan.points[1].shared.at(0).per_sd.si(), 0.03, 1e-15);
  EXPECT_NEAR(standard_u(scan.points[1]).si(), 0.05, 1e-15);
  EXPECT_EQ(scan.components.at(0).source, "SRT-99-020; ");
  EXPECT_TRUE(check(scan));
}

TEST(ScanOfFile, FlagsOtherChannelsAndWhatTheCallerLeavesOut) {
  const reflectance::MeasuredScan all = scan_of(two_channels(), 1).value();
  const reflectance::MeasuredScan steady = scan_of(two_channels(), 1, 2U).value();

  EXPECT_EQ(usable_points(all), (std::vector<std::size_t>{1, 3, 5}));
  EXPECT_EQ(usable_points(steady), (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(scan_of(two_channels(), 2).error().seen, "2 channels");
}

// Sheets of others: read between their readings, with an error of cross-validation that says how well.
TEST(ScanOfFile, InterpolatesTheDataOfOthers) {
  for (const char* name : {"retro-3m-yellow.alta", "anoblack-ec1.zemax.bsdf"}) {
    const auto bytes = file_content(shared_folder() / "data/measured" / name);
    if (!bytes) {
      std::cout << "no " << name << " of others here: not checked\n";
      continue;
    }
    SCOPED_TRACE(name);
    const MeasuredBrdf brdf = read_brdf(*bytes, name).value();
    const reflectance::MeasuredScan scan = scan_of(brdf, 0).value();

    const auto quantities = reflectance::ScanQuantities::make(scan);

    ASSERT_TRUE(quantities) << describe(quantities.error());
    const auto& candidates = quantities->interpolation().candidates;
    for (const auto& c : candidates) {
      std::cout << name << ", " << c.interpolant.guide().name << ": cross-validated on " << c.validated
                << " readings to " << 100.0 * c.cv_relative << " %\n";
    }
    EXPECT_GT(candidates.front().validated, scan.points.size() / 2);
    const auto& row = candidates.front().interpolant.table().rows().front();
    const auto rho = quantities->rho_dh(reflectance::Direction::from_angles(row.theta_i(), row.phi_i())).value();
    std::cout << "  rho_dh(" << in_degrees(row.theta_i()) << " deg) " << rho.value << " +- " << rho.expanded << ", "
              << 100.0 * rho.modelled_share << " % modelled\n";
    EXPECT_GT(rho.value, 0.0);
    EXPECT_LT(rho.value - rho.expanded, 1.0);
  }
}

}  // namespace
}  // namespace gonio::formats
