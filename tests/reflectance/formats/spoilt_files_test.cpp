// For each reader: nothing, pieces of a file, NaN and infinity in a value, an uncertainty or an angle. Each is refused
// with the file's name and a place in it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "reflectance/formats/bird_file.h"
#include "reflectance/formats/csv_file.h"
#include "reflectance/formats/format.h"
#include "reflectance/formats/merl_file.h"
#include "reflectance/formats/nexus_file.h"
#include "reflectance/formats/rgl_file.h"
#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A file, and where in it a value and an angle stand, as its bytes have them.
struct GoodFile {
  std::string name;
  std::string bytes;
  std::optional<std::string> sidecar;
  std::string value;
  std::string angle;
  bool is_binary = false;  ///< numbers are doubles or floats as they lie in memory
  bool has_float = false;
  std::size_t value_at = 0;  ///< where `value` stands, if not found by itself
};

template <class Number>
std::string in_memory(Number value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

MeasuredBrdf odd_reading() {
  MeasuredBrdf brdf;
  brdf.metadata.sample = "one odd reading";
  brdf.channels = {channel_at(550.0)};
  for (const double theta_r : {10.0, 36.875, 50.0})
    brdf.points.push_back({.theta_i_deg = 20.0,
                           .theta_r_deg = theta_r,
                           .f_per_sr = theta_r == 36.875 ? 0.8125 : 0.1,
                           .U_per_sr = 0.01,
                           .k = 2.0});
  return brdf;
}

std::string zemax_text() {
  return "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\nSampleRotation "
         "1\n0\n"
         "AngleOfIncidence 1\n20.5\nScatterAzimuth 2\n0 180\nScatterRadial 2\n0 10\nMonochrome\nDataBegin\nTIS 0.5\n"
         "0.8125 0.25\n0.8125 0.125\nDataEnd\n";
}

std::string merl_bytes() {
  SurfaceFile file;
  file.channels.push_back({.channel = channel_at(550.0), .surface = reflectance::wheat()});
  return bytes_of(write_merl(file), ".binary");
}

std::string rgl_bytes() {
  SurfaceFile file;
  file.channels.push_back({.channel = channel_at(550.0), .surface = reflectance::Surface(reflectance::wheat())});
  return bytes_of(write_rgl(file, {.nodes = 8, .incidence_step_deg = 44.0}), ".bsdf");
}

// Where the first number of a tensor file's field stands: behind its name are 2 bytes of dimensions, 1 of type, then 8
// of the offset.
std::size_t field_at(const std::string& bytes, const std::string& field) {
  std::uint64_t offset = 0;
  std::memcpy(&offset, bytes.data() + bytes.find(field) + field.size() + 3, sizeof offset);
  return offset;
}

// Of formats that say their end themselves: without the line's end behind it, which is no part of them.
std::string without_last_line_end(std::string text) {
  if (text.ends_with('\n')) text.pop_back();
  return text;
}

std::vector<GoodFile> good_files() {
  const Result<Export> csv = write_csv(odd_reading());
  const std::string merl = merl_bytes();
  const std::string rgl = rgl_bytes();
  constexpr std::size_t kMerlValue = 12 + 8 * (90 * 90 * 180 + 180 * 90 * 20);  // green, theta_h = 400/90 deg
  return {
      {"csv", bytes_of(csv, ".csv"), bytes_of(csv, ".json"), "0.8125", "36.875"},
      {"csv alone", bytes_of(csv, ".csv"), std::nullopt, "0.8125", "36.875"},
      {"csv of a spreadsheet", "theta_i [deg];phi_i [deg];theta_r [deg];phi_r [deg];BRDF\r\n20;0;36,875;0;0,8125\r\n",
       std::nullopt, "0,8125", "36,875"},
      {"bird", without_last_line_end(bytes_of(write_bird(odd_reading()), ".brdf")), std::nullopt, "0.8125", "36.875"},
      {"astm", "ASTM E1392\nNUM_POINTS 1\nVARS theta_i,phi_i,theta_s,phi_s,R\n0.25,0,0.375,0,0.8125\n", std::nullopt,
       "0.8125", "0.375"},
      {"zemax", without_last_line_end(zemax_text()), std::nullopt, "0.8125", "20.5"},
      {"ssdd",
       "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\nPARAM0_LIST 20.5\n"
       "PARAM2_LIST 10 20\nPARAM3_LIST 0\nDATA ascii\n0.25\n0.8125\n",
       std::nullopt, "0.8125", "20.5"},
      {"alta", "#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n0.375 0.25 0 0.8125\n", std::nullopt,
       "0.8125", "0.375"},
      {"merl", merl, std::nullopt, merl.substr(kMerlValue, sizeof(double)), "", true, false, kMerlValue},
      {"rgl", rgl, std::nullopt, rgl.substr(field_at(rgl, "spectra"), sizeof(float)), "", true, true,
       field_at(rgl, "spectra")},
      {"nexus", bytes_of(write_nexus(odd_reading()), ".nxs"), std::nullopt, in_memory(0.8125), in_memory(36.875),
       true}};
}

const std::vector<GoodFile>& all_good_files() {
  static const std::vector<GoodFile> kFiles = good_files();
  return kFiles;
}

std::string with(const GoodFile& file, const std::string& old, const std::string& in_its_place) {
  std::string bytes = file.bytes;
  const std::size_t at = &old == &file.value && file.value_at > 0 ? file.value_at : bytes.rfind(old);
  EXPECT_NE(at, std::string::npos);
  if (at != std::string::npos) bytes.replace(at, old.size(), in_its_place);
  return bytes;
}

void expect_refused(const GoodFile& file, const std::string& bytes) {
  const Result<MeasuredBrdf> read = read_brdf(bytes, "theirs.dat", file.sidecar);
  ASSERT_FALSE(read) << file.name << ": a value in silence";
  const Error& error = read.error();
  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  ASSERT_TRUE(error.where) << describe(error);
  EXPECT_THAT(error.where->file, HasSubstr("theirs.dat"));
  EXPECT_FALSE(error.seen.empty() && error.limit.empty()) << describe(error);
}

TEST(SpoiltFiles, AreGoodBeforeTheyAreSpoilt) {
  for (const GoodFile& file : all_good_files()) {
    const Result<MeasuredBrdf> read = read_brdf(file.bytes, "theirs.dat", file.sidecar);
    EXPECT_TRUE(read) << file.name << ": " << describe(read.error());
  }
}

TEST(SpoiltFiles, EmptyOrCutShortAreRefused) {
  for (const GoodFile& file : all_good_files()) {
    SCOPED_TRACE(file.name);
    const std::size_t size = file.bytes.size();
    // Without its last byte, within the last number, in the middle, in the header.
    for (const std::size_t length : {size - 1, size - 3, size - size / 10 - 1, size / 2, size / 7, 20UL, 1UL, 0UL}) {
      SCOPED_TRACE(length);
      std::string cut = file.bytes.substr(0, length);
      if (cut.ends_with('\n')) cut.pop_back();  // whole lines alone tell nothing where a format has no count
      expect_refused(file, cut);
    }
  }
}

TEST(SpoiltFiles, WithAValueThatIsNoneAreRefused) {
  for (const GoodFile& file : all_good_files()) {
    SCOPED_TRACE(file.name);
    if (!file.is_binary) {
      for (const char* none : {"nan", "NaN", "inf", "-Infinity", "1e999", "", "-", "0x1p3", "1.2.3", "0.5abc"}) {
        SCOPED_TRACE(none);
        expect_refused(file, with(file, file.value, none));
      }
      continue;
    }
    for (const double none : {kNaN, kInfinity, -kInfinity}) {
      SCOPED_TRACE(none);
      const std::string bytes = file.has_float ? in_memory(static_cast<float>(none)) : in_memory(none);
      expect_refused(file, with(file, file.value, bytes));
    }
  }
}

TEST(SpoiltFiles, WithAnAngleThatIsNoneAreRefused) {
  for (const GoodFile& file : all_good_files()) {
    SCOPED_TRACE(file.name);
    if (file.angle.empty()) continue;
    if (file.is_binary) {
      for (const double none : {kNaN, kInfinity, 120.0}) expect_refused(file, with(file, file.angle, in_memory(none)));
      continue;
    }
    for (const char* none : {"nan", "inf", "120", "-1e30", ""}) {
      SCOPED_TRACE(none);
      expect_refused(file, with(file, file.angle, none));
    }
  }
}

bool is_finite(const BrdfPoint& p) {
  return std::isfinite(p.theta_i_deg + p.phi_i_deg + p.theta_r_deg + p.phi_r_deg + p.f_per_sr);
}

// In its incidences, its normals, its wavelengths, its spectra and between them.
TEST(SpoiltFiles, AnRglFileWithNaNAnywhereHandsOnNone) {
  const std::string good = rgl_bytes();
  const std::string none = in_memory(static_cast<float>(kNaN));
  std::size_t refused = 0;
  for (std::size_t at = 0; at + none.size() <= good.size(); at += none.size()) {
    std::string bytes = good;
    bytes.replace(at, none.size(), none);
    const Result<MeasuredBrdf> read = read_brdf(bytes, "theirs.dat");
    if (read) {
      EXPECT_TRUE(std::ranges::all_of(read->points, is_finite)) << "byte " << at;
    } else {
      ++refused;
      EXPECT_THAT(describe(read.error()), HasSubstr("theirs.dat"));
    }
  }
  EXPECT_GT(refused, 100U);
}

}  // namespace
}  // namespace gonio::formats
