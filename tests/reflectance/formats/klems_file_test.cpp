#include "reflectance/formats/klems_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

constexpr std::size_t kPatches = 145;

// A second reader: the numbers between the tags, [reflected][incident].
std::vector<double> klems_values(const std::string& xml) {
  const std::size_t begin = xml.find("<ScatteringData>") + 16;
  std::string text = xml.substr(begin, xml.find("</ScatteringData>") - begin);
  std::ranges::replace(text, ',', ' ');
  std::istringstream in(text);
  std::vector<double> values;
  for (double value = 0.0; in >> value;) values.push_back(value);
  return values;
}

// The published basis: rings of theta and how many patches each has, patch j centred at 360 j/n deg.
std::size_t patch_of(double theta, double phi) {
  const std::vector<double> bounds{0, 5, 15, 25, 35, 45, 55, 65, 75, 90};
  const std::vector<std::size_t> counts{1, 8, 16, 20, 24, 24, 24, 16, 12};
  std::size_t first = 0;
  for (std::size_t ring = 0; ring < counts.size(); ++ring) {
    const auto n = static_cast<double>(counts[ring]);
    if (theta < bounds[ring + 1]) return first + static_cast<std::size_t>(std::lround(phi / 360.0 * n)) % counts[ring];
    first += counts[ring];
  }
  return first;
}

std::vector<double> values_of(const reflectance::Surface& surface) {
  SurfaceFile file;
  file.channels.push_back({.channel = channel_at(550.0), .surface = surface});
  return klems_values(bytes_of(write_klems(file), ".xml"));
}

TEST(KlemsFile, HoldsABrightReadingWhereItWas) {
  for (const MeasuredBrdf& brdf : {bright_retro(), bright_aside()}) {
    const BrdfPoint& bright = brightest(brdf);
    const Result<SurfaceFile> surfaces = surfaces_of(brdf);
    ASSERT_TRUE(surfaces) << describe(surfaces.error());
    const Result<Export> written = write_klems(*surfaces);
    const std::vector<double> values = klems_values(bytes_of(written, ".xml"));

    ASSERT_EQ(values.size(), kPatches * kPatches);
    // Lit from phi = 0, the patch of incidence is the one whose number has phi = 180 deg in the other basis.
    const std::size_t incident = patch_of(30.0, 180.0);
    const std::size_t reflected = patch_of(bright.theta_r_deg, bright.phi_r_deg);
    std::size_t found = 0;
    for (std::size_t r = 0; r < kPatches; ++r)
      if (values[r * kPatches + incident] > values[found * kPatches + incident]) found = r;
    EXPECT_EQ(found, reflected);
    EXPECT_GT(values[reflected * kPatches + incident], 1.0);
    EXPECT_TRUE(has_loss(written->losses, LossKind::Resampled));
  }
}

TEST(KlemsFile, KeepsTheReflectance) {
  const std::vector<double> values = values_of(reflectance::surface("lambertian", {{"rho", 0.4}}));
  const std::vector<double> bounds{0, 5, 15, 25, 35, 45, 55, 65, 75, 90};
  const std::vector<int> counts{1, 8, 16, 20, 24, 24, 24, 16, 12};
  double rho = 0.0;
  std::size_t patch = 0;
  for (std::size_t ring = 0; ring < counts.size(); ++ring) {
    const double low = std::sin(bounds[ring] * std::numbers::pi / 180.0);
    const double high = std::sin(bounds[ring + 1] * std::numbers::pi / 180.0);
    for (int j = 0; j < counts[ring]; ++j, ++patch)
      rho += values[patch * kPatches] * std::numbers::pi * (high * high - low * low) / counts[ring];
  }
  EXPECT_EQ(patch, kPatches);
  EXPECT_NEAR(rho, 0.4, 1e-6);
}

TEST(KlemsFile, HasAMirrorOnItsDiagonal) {
  const std::vector<double> values =
      values_of(reflectance::surface("glint", {{"slope_variance", 1e-3}, {"refractive_index", 1.34}}));
  for (const std::size_t incident : {std::size_t{0}, patch_of(30.0, 90.0), patch_of(50.0, 270.0)}) {
    std::size_t found = 0;
    for (std::size_t r = 0; r < kPatches; ++r)
      if (values[r * kPatches + incident] > values[found * kPatches + incident]) found = r;
    EXPECT_EQ(found, incident);
  }
}

TEST(KlemsFile, EscapesWhatIsNoXml) {
  SurfaceFile file;
  file.metadata.sample = "a<b & c\n";
  file.channels.push_back({.channel = {}, .surface = reflectance::surface("lambertian", {{"rho", 0.4}})});
  const Result<Export> written = write_klems(file);
  EXPECT_THAT(bytes_of(written, ".xml"), HasSubstr("<Name>a&lt;b &amp; c </Name>"));
  EXPECT_THAT(bytes_of(written, ".xml"), HasSubstr("Reflection Back"));
  EXPECT_FALSE(write_klems({}));
}

}  // namespace
}  // namespace gonio::formats
