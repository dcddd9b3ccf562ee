#include "reflectance/formats/merl_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;
using Vec = std::array<double, 3>;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kSize = 34'992'012;

SurfaceFile one_channel(const reflectance::Surface& surface) {
  SurfaceFile file;
  file.channels.push_back({.channel = channel_at(550.0), .surface = surface});
  return file;
}

Vec rotated(const Vec& v, const Vec& axis, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double along = (axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]) * (1.0 - c);
  const Vec cross{axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2], axis[0] * v[1] - axis[1] * v[0]};
  return {v[0] * c + axis[0] * along + cross[0] * s, v[1] * c + axis[1] * along + cross[1] * s,
          v[2] * c + axis[2] * along + cross[2] * s};
}

Vec at(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// A second reader, from the description that comes with the data: half vector, then the incident one turned by -phi_h
// about the normal and by -theta_h about y; square-root spacing along theta_h. The table's cell, no interpolation.
double looked_up(const std::string& bytes, const Vec& in, const Vec& out, std::size_t colour) {
  Vec h{in[0] + out[0], in[1] + out[1], in[2] + out[2]};
  const double length = std::hypot(h[0], h[1], h[2]);
  for (double& part : h) part /= length;
  const double theta_h = std::acos(std::min(1.0, h[2]));
  const double phi_h = std::atan2(h[1], h[0]);
  const Vec d = rotated(rotated(in, {0, 0, 1}, -phi_h), {0, 1, 0}, -theta_h);
  const double theta_d = std::acos(std::min(1.0, d[2]));
  double phi_d = std::atan2(d[1], d[0]);
  if (phi_d < 0.0) phi_d += std::numbers::pi;
  const auto cell = [](double x, int count) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(x + 1e-6), 0, count - 1));
  };
  const std::size_t index = cell(phi_d / kDegree, 180) +
                            180 * (cell(theta_d / kDegree, 90) + 90 * cell(std::sqrt(theta_h / kDegree * 90.0), 90));
  double stored = 0.0;
  std::memcpy(&stored, bytes.data() + 12 + 8 * (colour * 90 * 90 * 180 + index), sizeof(stored));
  constexpr std::array<double, 3> kScale{1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
  return stored * kScale.at(colour);
}

TEST(MerlFile, OfAFormulaIsReadByASecondReader) {
  const reflectance::Surface wheat = reflectance::wheat();
  const Result<Export> written = write_merl(one_channel(wheat));
  ASSERT_TRUE(written) << describe(written.error());
  const std::string& bytes = bytes_of(written, ".binary");
  ASSERT_EQ(bytes.size(), kSize);

  std::array<std::int32_t, 3> dimensions{};
  std::memcpy(dimensions.data(), bytes.data(), 12);
  EXPECT_EQ(dimensions, (std::array<std::int32_t, 3>{90, 90, 180}));
  // Nodes lie up to 1 deg and 2 n/90 deg away, so that a smooth surface is met to some per cent.
  for (const double theta_i : {20.0, 45.0, 60.0}) {
    for (const double theta_r : {10.0, 35.0, 55.0}) {
      for (const double phi : {0.0, 50.0, 130.0, 250.0}) {
        const double f = in_per_steradian(wheat.eval(reflectance::geometry(theta_i, theta_r, phi)));
        for (const std::size_t colour : {0u, 1u, 2u})
          EXPECT_NEAR(looked_up(bytes, at(theta_i * kDegree, 0), at(theta_r * kDegree, phi * kDegree), colour), f,
                      0.06 * f)
              << theta_i << " " << theta_r << " " << phi;
      }
    }
  }
  EXPECT_TRUE(has_loss(written->losses, LossKind::Wavelength));
  EXPECT_FALSE(has_loss(written->losses, LossKind::Resampled)) << "a formula is not resampled";

  const Result<MeasuredBrdf> read = read_merl(bytes, "wheat.binary", {.step = 7, .all_channels = false});
  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_GT(read->points.size(), 1000u);
  for (const BrdfPoint& point : read->points) {
    const double f = in_per_steradian(wheat.eval(geometry_of(point)));
    EXPECT_NEAR(point.f_per_sr, f, 1e-10 * f);
  }
  EXPECT_FALSE(read_merl(bytes.substr(0, kSize - 1), "cut.binary"));
  EXPECT_FALSE(read_merl(bytes + "x", "long.binary"));
  EXPECT_FALSE(read_merl(bytes, "x.binary", {.step = 0}));
}

TEST(MerlFile, HoldsABrightReadingWhereItWas) {
  const MeasuredBrdf brdf = bright_retro();
  const Result<SurfaceFile> surfaces = surfaces_of(brdf);
  ASSERT_TRUE(surfaces) << describe(surfaces.error());
  const Result<Export> written = write_merl(*surfaces);
  const std::string& bytes = bytes_of(written, ".binary");

  const Vec source = at(30.0 * kDegree, 0.0);
  EXPECT_GT(looked_up(bytes, source, source, 1), 4.5);
  EXPECT_LT(looked_up(bytes, source, at(30.0 * kDegree, 180.0 * kDegree), 1), 0.2) << "not where a mirror sends it";
  EXPECT_LT(looked_up(bytes, at(60.0 * kDegree, 0.0), at(60.0 * kDegree, 0.0), 1), 0.2);
  EXPECT_TRUE(has_loss(written->losses, LossKind::Resampled));
  EXPECT_TRUE(has_loss(written->losses, LossKind::Extrapolated));
  const Result<MeasuredBrdf> read = read_merl(bytes, "bright.binary", {.step = 1, .all_channels = false});
  ASSERT_TRUE(read) << describe(read.error());
  const BrdfPoint& found = brightest(*read);
  EXPECT_GT(found.f_per_sr, 4.5);
  EXPECT_LT(degrees_from_view(found, found.theta_i_deg, 0.0), 3.0);
  EXPECT_NEAR(found.theta_i_deg, 30.0, 1.0);
}

TEST(MerlFile, SaysWhereABadOneIsBad) {
  const auto said = [](const std::string& bytes) {
    const Result<MeasuredBrdf> read = read_merl(bytes, "bad.binary");
    return read ? std::string("it was read") : describe(read.error());
  };
  EXPECT_THAT(said(""), HasSubstr("bad.binary"));
  EXPECT_THAT(said(std::string("\x5A\0\0\0\x5A\0\0\0\xB4\0\0\0", 12)), HasSubstr("ends at byte 12"));
  EXPECT_THAT(said(std::string("\xFF\xFF\xFF\x7F\x5A\0\0\0\xB4\0\0\0", 12)), HasSubstr("2147483647"));
  std::string bytes("\x5A\0\0\0\x5A\0\0\0\xB4\0\0\0", 12);
  bytes.resize(kSize, '\xFF');  // NaN in every cell
  EXPECT_THAT(said(bytes), HasSubstr("finite"));
  EXPECT_FALSE(write_merl({}));
}

}  // namespace
}  // namespace gonio::formats
