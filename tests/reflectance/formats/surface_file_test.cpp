// Surfaces of files as others make them: out of order, with readings twice, below zero, in one plane, of one incidence.
#include "reflectance/formats/surface_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "reflectance/table/tabulated_surface.h"
#include "tests/reflectance/formats/sample_files.h"

namespace gonio::formats {
namespace {

using reflectance::TabulatedSurface;
using testing::HasSubstr;

double value_at(const Result<SurfaceFile>& surfaces, const BrdfPoint& p) {
  return in_per_steradian(surfaces.value().channels.at(0).surface.eval(geometry_of(p)));
}

void expect_its_readings(const MeasuredBrdf& brdf) {
  const Result<SurfaceFile> surfaces = surfaces_of(brdf);
  ASSERT_TRUE(surfaces) << describe(surfaces.error());
  for (const BrdfPoint& p : brdf.points) EXPECT_NEAR(value_at(surfaces, p), p.f_per_sr, 1e-6);
}

TEST(SurfacesOf, AFileOutOfOrderAreThoseOfItsOrder) {
  MeasuredBrdf brdf = bright_aside();
  constexpr std::uint64_t kSeed = 20261122;
  std::mt19937_64 chance(kSeed);
  SCOPED_TRACE(kSeed);
  std::ranges::shuffle(brdf.points, chance);

  expect_its_readings(brdf);
}

TEST(SurfacesOf, ReadingsTwiceAreTheirMean) {
  MeasuredBrdf brdf = bright_aside();
  BrdfPoint again = brightest(brdf);
  again.f_per_sr = 6.0;
  brdf.points.push_back(again);

  EXPECT_NEAR(value_at(surfaces_of(brdf), again), 5.5, 1e-6) << "5 and 6 of the same U";
}

TEST(SurfacesOf, ReadingsBelowZeroKeepTheirSign) {
  MeasuredBrdf brdf = bright_aside();
  for (BrdfPoint& p : brdf.points) p.f_per_sr -= 0.2;

  expect_its_readings(brdf);
}

TEST(SurfacesOf, ReadingsInThePlaneOfIncidenceAreRings) {
  MeasuredBrdf brdf = bright_retro();
  std::erase_if(brdf.points, [](const BrdfPoint& p) { return p.phi_r_deg != 0.0 && p.phi_r_deg != 180.0; });

  expect_its_readings(brdf);
}

TEST(SurfacesOf, OneIncidenceIsTheSameUnderEveryOther) {
  MeasuredBrdf brdf = bright_retro();
  std::erase_if(brdf.points, [](const BrdfPoint& p) { return p.theta_i_deg != 30.0; });

  expect_its_readings(brdf);
}

TEST(SurfacesOf, HalfOfTheAzimuthsCoverHalf) {
  MeasuredBrdf brdf = bright_retro();
  brdf.metadata.symmetry = reflectance::TableSymmetry::Turn;
  std::erase_if(brdf.points, [](const BrdfPoint& p) { return p.phi_r_deg > 180.0; });

  expect_its_readings(brdf);
  const Result<SurfaceFile> surfaces = surfaces_of(brdf);
  const auto* table = surfaces->channels[0].surface.as<TabulatedSurface>();
  const auto covers = [&](double phi_r_deg) {
    const BrdfPoint p{.theta_i_deg = 30.0, .theta_r_deg = 45.0, .phi_r_deg = phi_r_deg};
    return table->covers(directions_of(p).i, directions_of(p).r);
  };
  EXPECT_TRUE(covers(85.0));
  EXPECT_FALSE(covers(275.0));
}

TEST(SurfacesOf, ATableWithAnIncidenceForEachValueHasItsWord) {
  MeasuredBrdf brdf;
  brdf.channels = {channel_at(550.0)};
  for (int k = 0; k < 9000; ++k) brdf.points.push_back({.theta_i_deg = 0.01 * k, .theta_r_deg = 20.0, .f_per_sr = 0.1});

  const Result<SurfaceFile> surfaces = surfaces_of(brdf);

  ASSERT_FALSE(surfaces);
  EXPECT_THAT(describe(surfaces.error()), HasSubstr("4097 incidences"));
  EXPECT_THAT(describe(surfaces.error()), HasSubstr("channel 550nm"));
}

}  // namespace
}  // namespace gonio::formats
