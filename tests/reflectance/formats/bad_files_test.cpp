// One table over every format that is read: what another program broke, cut off or filled with NaN has its word, which
// names the file, and is never taken for a measurement.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <regex>
#include <stdexcept>
#include <string>

#include "reflectance/formats/astm_file.h"
#include "reflectance/formats/bird_file.h"
#include "reflectance/formats/csv_file.h"
#include "reflectance/formats/format.h"
#include "reflectance/formats/merl_file.h"
#include "reflectance/formats/nexus_file.h"
#include "reflectance/formats/rgl_file.h"
#include "reflectance/formats/ssdd_file.h"
#include "reflectance/formats/surface_file.h"
#include "reflectance/formats/zemax_file.h"
#include "tests/reflectance/formats/sample_files.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

constexpr const char* kName = "night/strange.file";

constexpr const char* kAlta =
    "#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n#PARAM_OUT INV_STERADIAN\n"
    "0.5 0.0 0.1 0.25 0.31\n0.5 0.0 0.2 0.25 0.32\n0.5 0.0 0.3 0.25 0.33\n";

struct Sample {
  std::string bytes;
  std::optional<std::string> sidecar = std::nullopt;
  bool says_its_length = true;  ///< else a file that ends after any of its rows is a whole one
};

std::string first_file(const Result<Export>& written) {
  return written ? written->files.front().bytes : describe(written.error());
}

Sample sample(Format format) {
  const MeasuredBrdf brdf = bright_retro();
  const auto surfaces = [&] { return surfaces_of(brdf).value(); };
  switch (format) {
    case Format::Csv: {
      const auto csv = write_csv(brdf);
      return {bytes_of(csv, ".csv"), bytes_of(csv, ".json")};
    }
    case Format::Bird:
      return {first_file(write_bird(brdf))};
    case Format::Astm:
      return {first_file(write_astm(brdf))};
    case Format::Zemax:
      return {first_file(write_zemax(surfaces()))};
    case Format::Merl:
      return {first_file(write_merl(surfaces()))};
    case Format::Ssdd:
      return {first_file(write_ssdd(surfaces(), ssdd_axes_of(brdf)))};
    case Format::Rgl:
      return {first_file(write_rgl(surfaces(), {}))};
    case Format::Nexus:
      return {first_file(write_nexus(brdf))};
    case Format::Alta:
      return {kAlta, std::nullopt, false};
    case Format::Pab:
    case Format::Klems:
      break;  // written only
  }
  throw std::invalid_argument("no format that is read");
}

class BadFile : public testing::TestWithParam<Format> {
 protected:
  // Written by each test itself: a list of the tests must not wait for files of megabytes.
  const Sample sample_ = sample(GetParam());

  // A word that names the file; who reads it is told which one to look at.
  void expect_refused(std::string_view bytes, const std::string& what) const {
    const Result<MeasuredBrdf> read = read_brdf(bytes, kName, sample_.sidecar);
    ASSERT_FALSE(read.has_value()) << what << ": read as " << read->points.size() << " points";
    EXPECT_THAT(describe(read.error()), HasSubstr(kName)) << what;
    EXPECT_EQ(read.error().code, ErrorCode::InvalidInput) << what << ": " << describe(read.error());
  }
};

TEST_P(BadFile, AsItShouldBeIsRead) {
  EXPECT_EQ(detect_format(sample_.bytes), GetParam());
  const Result<MeasuredBrdf> read = read_brdf(sample_.bytes, kName, sample_.sidecar);
  ASSERT_TRUE(read.has_value()) << describe(read.error());
}

TEST_P(BadFile, CutOffAnywhereIsRefused) {
  constexpr std::size_t kCuts = 61;
  const std::string& whole = sample_.bytes;
  for (std::size_t n = 0; n < kCuts; ++n) {
    const std::size_t bytes = whole.size() * n / kCuts;
    if (!sample_.says_its_length && bytes > 0 && whole[bytes - 1] == '\n') continue;
    expect_refused(std::string_view(whole).substr(0, bytes), "cut to " + std::to_string(bytes));
  }
}

TEST_P(BadFile, WithTheEndOfAnotherFileIsRefused) {
  const std::string& whole = sample_.bytes;
  const std::string half = whole.substr(0, whole.size() / 2);
  expect_refused(half + std::string(500, '\0'), "zeros from the middle on");
  expect_refused(half + "\n<html><body>503 Service Unavailable</body></html>\n", "a web page from the middle on");
}

INSTANTIATE_TEST_SUITE_P(OfEachFormat, BadFile,
                         testing::Values(Format::Csv, Format::Bird, Format::Astm, Format::Zemax, Format::Merl,
                                         Format::Ssdd, Format::Rgl, Format::Nexus, Format::Alta),
                         [](const auto& made) { return std::string(format_name(made.param)); });

// ---- values that are no numbers ----

class NoNumber : public testing::TestWithParam<Format> {};

// The text after the header, where all numbers are angles or values.
std::size_t body_of(Format format, const std::string& bytes) {
  switch (format) {
    case Format::Csv:
      return bytes.find('\n');
    case Format::Astm:
      return bytes.rfind("\nVARS");
    case Format::Alta:
      return bytes.rfind('#');
    default:
      return bytes.size() / 2;
  }
}

TEST_P(NoNumber, InTheMidstIsRefusedByItsPlace) {
  const Sample whole = sample(GetParam());
  const std::size_t from = whole.bytes.find('\n', body_of(GetParam(), whole.bytes) + 1);
  ASSERT_NE(from, std::string::npos);
  const std::string body = whole.bytes.substr(from);
  const std::regex number(R"([-+]?[0-9]+\.[0-9]+(e[-+]?[0-9]+)?)");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(body, found, number)) << body.substr(0, 200);
  for (const char* bad : {"nan", "NaN", "-nan", "inf", "-Infinity", "1e999", "0.1.2", "0x10", "--", "1,5"}) {
    SCOPED_TRACE(bad);
    const std::string spoilt = whole.bytes.substr(0, from) + found.prefix().str() + bad + found.suffix().str();

    const Result<MeasuredBrdf> read = read_brdf(spoilt, kName, whole.sidecar);

    ASSERT_FALSE(read.has_value());
    EXPECT_THAT(describe(read.error()), HasSubstr(kName));
    const InputLocation& where = read.error().where.value();
    EXPECT_TRUE(where.line > 0 || !where.field.empty()) << describe(read.error());
  }
}

INSTANTIATE_TEST_SUITE_P(OfEachText, NoNumber,
                         testing::Values(Format::Csv, Format::Bird, Format::Astm, Format::Zemax, Format::Ssdd,
                                         Format::Alta),
                         [](const auto& made) { return std::string(format_name(made.param)); });

TEST(NoFormat, IsRefusedByItsName) {
  for (const std::string_view bytes :
       {std::string_view(""), std::string_view("\n\n\n"), std::string_view("\0\0\0\0", 4),
        std::string_view("%PDF-1.4\n"), std::string_view("\x89PNG\r\n\x1a\n"), std::string_view("{\"a\": 1}"),
        std::string_view("[1, 2, 3]"), std::string_view("name,age\nAda,36\n"), std::string_view("PK\x03\x04")}) {
    const Result<MeasuredBrdf> read = read_brdf(bytes, kName);
    ASSERT_FALSE(read.has_value()) << bytes;
    EXPECT_THAT(describe(read.error()), HasSubstr(kName)) << bytes;
  }
}

}  // namespace
}  // namespace gonio::formats
