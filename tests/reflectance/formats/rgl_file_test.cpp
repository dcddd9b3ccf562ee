#include "reflectance/formats/rgl_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <vector>

#include "reflectance/formats/tensor_file.h"
#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

// A second reader by the container's description: after "tensor_file\0", version and count, each field's name, rank,
// kind, place and shape; the machine's own byte order, which must be little.
struct RglField {
  std::vector<std::uint64_t> shape;
  std::vector<float> floats;
};

std::map<std::string, RglField> rgl_fields(const std::string& bytes) {
  std::map<std::string, RglField> fields;
  std::size_t at = 14;
  const auto take = [&](auto& number) {
    std::memcpy(&number, bytes.data() + at, sizeof(number));
    at += sizeof(number);
  };
  std::uint32_t count = 0;
  take(count);
  for (std::uint32_t n = 0; n < count; ++n) {
    std::uint16_t length = 0;
    take(length);
    const std::string name = bytes.substr(at, length);
    at += length;
    std::uint16_t rank = 0;
    std::uint8_t kind = 0;
    std::uint64_t offset = 0;
    take(rank);
    take(kind);
    take(offset);
    RglField field;
    std::uint64_t size = 1;
    for (std::uint16_t k = 0; k < rank; ++k) {
      field.shape.push_back(0);
      take(field.shape.back());
      size *= field.shape.back();
    }
    EXPECT_EQ(offset % 8, 0u);
    if (kind == 10) {
      field.floats.resize(size);
      std::memcpy(field.floats.data(), bytes.data() + offset, size * sizeof(float));
    }
    fields[name] = field;
  }
  return fields;
}

// f_r mu_o as the reference loader's formula has it for an even distribution of visible normals: the table at the half
// vector, bilinear, at one of its incidences.
double f_mu(const std::map<std::string, RglField>& fields, std::size_t t, double theta_o, double phi_o) {
  const RglField& table = fields.at("spectra");
  const std::size_t n = table.shape[3];
  const double theta_i = static_cast<double>(fields.at("theta_i").floats[t]);
  const double x = std::sin(theta_i) + std::sin(theta_o) * std::cos(phi_o);
  const double y = std::sin(theta_o) * std::sin(phi_o);
  const double z = std::cos(theta_i) + std::cos(theta_o);
  const double theta_m = std::atan2(std::hypot(x, y), z);
  const double u = std::sqrt(theta_m * 2.0 / kPi) * static_cast<double>(n - 1);
  const double v = (std::atan2(y, x) + kPi) / (2.0 * kPi) * static_cast<double>(n - 1);
  const std::size_t cu = std::min(static_cast<std::size_t>(u), n - 2);
  const std::size_t cv = std::min(static_cast<std::size_t>(v), n - 2);
  const auto value = [&](std::size_t row, std::size_t column) {
    return static_cast<double>(table.floats[(t * n + row) * n + column]);
  };
  const double su = u - static_cast<double>(cu);
  const double sv = v - static_cast<double>(cv);
  const double even = (1 - sv) * ((1 - su) * value(cv, cu) + su * value(cv, cu + 1)) +
                      sv * ((1 - su) * value(cv + 1, cu) + su * value(cv + 1, cu + 1));
  return even * static_cast<double>(fields.at("ndf").floats[0]) /
         (4.0 * static_cast<double>(fields.at("sigma").floats[0]));
}

SurfaceFile one_surface(const reflectance::Surface& surface) {
  SurfaceFile file;
  file.channels.push_back({.channel = channel_at(550.0), .surface = surface});
  return file;
}

TEST(RglFile, OfAFormulaIsReadByASecondReader) {
  const reflectance::Surface minnaert = reflectance::surface("minnaert", {{"rho", 0.5}, {"k", 0.8}});
  const Result<Export> written = write_rgl(one_surface(minnaert), {.nodes = 64, .incidence_step_deg = 15.0});
  ASSERT_TRUE(written) << describe(written.error());
  const std::map<std::string, RglField> fields = rgl_fields(bytes_of(written, ".bsdf"));

  ASSERT_EQ(fields.at("spectra").shape, (std::vector<std::uint64_t>{1, 6, 1, 64, 64}));
  EXPECT_EQ(fields.at("wavelengths").floats, std::vector<float>{550.0F});
  for (std::size_t t = 0; t < 6; ++t) {
    for (const double theta_o : {5.0, 20.0, 40.0, 60.0}) {
      for (const double phi_o : {10.0, 80.0, 170.0, 290.0}) {
        const double f =
            in_per_steradian(minnaert.eval(reflectance::geometry(15.0 * static_cast<double>(t), theta_o, phi_o)));
        const double expected = f * std::cos(theta_o * kDegree);
        EXPECT_NEAR(f_mu(fields, t, theta_o * kDegree, phi_o * kDegree), expected, 4e-3 * expected)
            << t << " " << theta_o << " " << phi_o;
      }
    }
  }
}

TEST(RglFile, HoldsABrightReadingWhereItWas) {
  for (const MeasuredBrdf& brdf : {bright_retro(), bright_aside()}) {
    const BrdfPoint& bright = brightest(brdf);
    const Result<Export> written = write_rgl(surfaces_of(brdf).value(), {.incidence_step_deg = 44.0});
    const std::map<std::string, RglField> fields = rgl_fields(bytes_of(written, ".bsdf"));
    const std::size_t lit_from_30 = 2;  // 0, 15, 30: incidences that were measured are kept, whatever the step
    ASSERT_NEAR(fields.at("theta_i").floats.at(lit_from_30), 30.0 * kDegree, 1e-6);
    double most = 0.0;
    double theta = 0.0;
    double phi = 0.0;
    for (double theta_o = 1.0; theta_o < 80.0; theta_o += 1.0) {
      for (double phi_o = 0.0; phi_o < 360.0; phi_o += 2.0) {
        const double f = f_mu(fields, lit_from_30, theta_o * kDegree, phi_o * kDegree) / std::cos(theta_o * kDegree);
        if (f <= most) continue;
        most = f;
        theta = theta_o;
        phi = phi_o;
      }
    }
    EXPECT_NEAR(most, 5.0, 0.75);
    EXPECT_LT(degrees_from_view({.theta_r_deg = theta, .phi_r_deg = phi}, bright.theta_r_deg, bright.phi_r_deg), 2.1);
    const Result<MeasuredBrdf> read = read_rgl(bytes_of(written, ".bsdf"), "x.bsdf");
    ASSERT_TRUE(read) << describe(read.error());
    EXPECT_NEAR(brightest(*read).theta_i_deg, 30.0, 1e-5);
    EXPECT_NEAR(brightest(*read).f_per_sr, 5.0, 0.5);
    EXPECT_LT(degrees_from_view(brightest(*read), bright.theta_r_deg, bright.phi_r_deg), 2.1);
    EXPECT_TRUE(has_loss(written->losses, LossKind::Precision));
  }
}

TEST(RglFile, ReadsBackItsNodesAsTheFormula) {
  SurfaceFile file = one_surface(reflectance::wheat());
  file.channels.push_back(
      {.channel = channel_at(450.0), .surface = reflectance::surface("lambertian", {{"rho", 0.5}})});
  file.metadata.sample = "wheat";
  const Result<MeasuredBrdf> read =
      read_rgl(bytes_of(write_rgl(file, {.nodes = 24, .incidence_step_deg = 22.0}), ".bsdf"), "x.bsdf");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->metadata.sample, "wheat");
  ASSERT_EQ(read->channels.size(), 2u);
  EXPECT_EQ(read->channels[0].wavelength_nm, 450.0);
  for (const BrdfPoint& p : read->points) {
    const double f = in_per_steradian(file.channels[1 - p.channel].surface.eval(geometry_of(p)));
    EXPECT_NEAR(p.f_per_sr, f, 1e-4 * f + 1e-6);
  }
}

// A file with a distribution of visible normals: its tables stand where the warp puts even points. With a density that
// rises as u from 0, u = sqrt(s).
TEST(RglFile, OfOthersIsReadThroughTheWarpOfItsNormals) {
  const std::vector<double> nodes{0.0, 1.0, 0.0, 1.0};
  const std::string bytes = write_tensors({{"description", true, {{4}, {'b', 'l', 'u', 'e'}}},
                                           {"phi_i", false, {{1}, {0.0}}},
                                           {"theta_i", false, {{1}, {0.0}}},
                                           {"ndf", false, {{2, 2}, {8, 8, 8, 8}}},
                                           {"sigma", false, {{2, 2}, {0.5, 0.5, 0.5, 0.5}}},
                                           {"vndf", false, {{1, 1, 2, 2}, nodes}},
                                           {"rgb", false, {{1, 1, 3, 2, 5}, std::vector<double>(30, 0.25)}},
                                           {"jacobian", true, {{1}, {1}}}});
  const Result<MeasuredBrdf> read = read_rgl(bytes, "blue.bsdf");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->metadata.sample, "blue");
  ASSERT_EQ(read->channels.size(), 3u);
  // s = 0, 1/4 along the row: u = 0, 1/2; theta_m = (pi/2) u^2, and light from the normal leaves at twice that.
  ASSERT_EQ(read->points.size(), 6u) << "at s = 1/2 theta_r is 90 deg";
  EXPECT_NEAR(read->points[0].theta_r_deg, 0.0, 1e-9);
  EXPECT_NEAR(read->points[3].theta_r_deg, 45.0, 1e-9);
  // f mu = 0.25 * 8 / (4 * 0.5)
  EXPECT_NEAR(read->points[3].f_per_sr, 1.0 / std::cos(45.0 * kDegree), 1e-9);
}

TEST(RglFile, OfMoreValuesThanAreReadLeavesOutWavelengthsEvenly) {
  SurfaceFile file;
  for (const double wavelength : {400.0, 500.0, 600.0, 700.0, 800.0})
    file.channels.push_back({.channel = channel_at(wavelength), .surface = reflectance::wheat()});
  const std::string bytes = bytes_of(write_rgl(file, {.nodes = 8, .incidence_step_deg = 44.0}), ".bsdf");
  const std::size_t of_one = 3 * 8 * 8;

  const Result<MeasuredBrdf> read = read_rgl(bytes, "wheat.bsdf", 3 * of_one);

  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_EQ(read->channels.size(), 3u) << "every second";
  EXPECT_EQ(read->channels[1].wavelength_nm, 600.0);
  ASSERT_FALSE(read->metadata.remarks.empty());
  EXPECT_THAT(read->metadata.remarks.back().second, HasSubstr("2 of 5 wavelengths"));
  EXPECT_EQ(read->points.size(), 3 * read_rgl(bytes, "wheat.bsdf")->points.size() / 5);
  EXPECT_THAT(describe(read_rgl(bytes, "wheat.bsdf", 10).error()), HasSubstr("more points"));
}

TEST(RglFile, SaysWhereABadOneIsBad) {
  const std::string good =
      bytes_of(write_rgl(one_surface(reflectance::wheat()), {.nodes = 4, .incidence_step_deg = 44.0}), ".bsdf");
  ASSERT_TRUE(read_rgl(good, "good.bsdf"));
  const auto said = [](const std::string& bytes) {
    const Result<MeasuredBrdf> read = read_rgl(bytes, "bad.bsdf");
    return read ? std::string("it was read") : describe(read.error());
  };
  for (std::size_t length = 0; length + 1 < good.size(); ++length)
    EXPECT_NE(said(good.substr(0, length)), "it was read") << length;
  EXPECT_THAT(said("# Zemax\nSource Measured\n"), HasSubstr("tensor_file"));
  std::string bad = good;
  bad.replace(bad.find("spectra"), 7, "spectre");
  EXPECT_THAT(said(bad), HasSubstr("spectra"));
  bad = good;
  bad.replace(bad.find("luminance") + 9 + 2 + 1 + 8, 8, std::string(8, '\xFF'));  // its first length
  EXPECT_THAT(said(bad), HasSubstr("shape of luminance"));
  bad = good;
  bad.replace(bad.size() - 5, 4, std::string("\0\0\xC0\x7F", 4));  // NaN, before the switch at the end
  EXPECT_THAT(said(bad), HasSubstr("finite"));
  EXPECT_FALSE(write_rgl({}));
  EXPECT_FALSE(write_rgl(one_surface(reflectance::wheat()), {.nodes = 1}));
}

}  // namespace
}  // namespace gonio::formats
