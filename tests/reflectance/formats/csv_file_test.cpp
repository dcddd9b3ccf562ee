#include "reflectance/formats/csv_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "tests/reflectance/formats/sample_files.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kCsvSeed = 20260107;

// Any bits that make a finite number of moderate size: the decimals of a file must give each of them back.
double odd_number(std::mt19937_64& random, double most) {
  return std::ldexp(static_cast<double>(random()), -64) * most;
}

MeasuredBrdf odd_brdf() {
  std::mt19937_64 random(kCsvSeed);
  MeasuredBrdf brdf;
  brdf.metadata = {.id = "urn:gonio:scan-7",
                   .description = "a line\nand \"another\", with a comma",
                   .method = Method::Simulation,
                   .measured_at = "2026-01-01T12:00:00Z",
                   .sample = "wheat, \xC3\xA4hren",
                   .symmetry = reflectance::TableSymmetry::Turn,
                   .medium = "air",
                   .temperature_c = 23.1,
                   .references = {"SRS-99 0412", "certificate 7"},
                   .remarks = {{"lamp", "xenon"}, {"lamp", "no 2"}}};
  brdf.channels = {channel_at(550.1), {.name = "R", .incident = Polarisation::S, .reflected = Polarisation::P}};
  brdf.flag_names = {"near-zero", "dark-extrapolated", "few-neighbours"};
  for (int n = 0; n < 2000; ++n) {
    BrdfPoint p{.theta_i_deg = odd_number(random, 90.0),
                .phi_i_deg = odd_number(random, 720.0) - 360.0,
                .theta_r_deg = odd_number(random, 180.0) - 90.0,
                .phi_r_deg = odd_number(random, 720.0) - 360.0,
                .f_per_sr = odd_number(random, 2.0) - 1.0,
                .U_per_sr = odd_number(random, 0.1),
                .k = 2.0 + odd_number(random, 1.0),
                .u_shared_per_sr = odd_number(random, 0.01)};
    p.channel = static_cast<std::uint32_t>(random() % 2);
    p.flags = static_cast<std::uint32_t>(random() % 8);
    brdf.points.push_back(p);
  }
  brdf.points[0].f_per_sr = -0.0;
  brdf.points[1].f_per_sr = 5e-324;
  brdf.points[2].f_per_sr = -1.7976931348623157e+299;
  return brdf;
}

TEST(CsvFile, GivesEveryBitBack) {
  SCOPED_TRACE(testing::Message() << "seed " << kCsvSeed);
  const MeasuredBrdf brdf = odd_brdf();

  const Result<Export> written = write_csv(brdf);
  ASSERT_TRUE(written) << describe(written.error());
  const Result<MeasuredBrdf> read = read_csv(bytes_of(written, ".csv"), bytes_of(written, ".json"), "wheat.csv");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(*read, brdf);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(read->points[0].f_per_sr), std::bit_cast<std::uint64_t>(-0.0));
  EXPECT_TRUE(written->losses.empty());
}

// A second reader, by the C library and the header's names alone.
TEST(CsvFile, HoldsTheBrightReadingWhereItWas) {
  const Result<Export> written = write_csv(bright_retro());
  const std::string& csv = bytes_of(written, ".csv");

  ASSERT_EQ(csv.rfind("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr,U_per_sr,k,", 0), 0u);
  EXPECT_THAT(csv, HasSubstr("\n30,0,30,0,5,0.01,2,0,0,550,\n"));
}

TEST(CsvFile, OfOthersNeedsOnlyTheFiveColumns) {
  const std::string csv =
      "f_per_sr, wavelength_nm,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,flags\r\n"
      "-1e-3,650,10,0,20,90,weak\r\n0.5,450,10,0,20,270,weak|odd\r\n0.6,650,10,0,30,270,\r\n";

  const Result<MeasuredBrdf> read = read_csv(csv, std::nullopt, "theirs.csv");

  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_EQ(read->points.size(), 3u);
  ASSERT_EQ(read->channels.size(), 2u);
  EXPECT_EQ(read->channels[1].wavelength_nm, 450.0);
  EXPECT_EQ(read->points[2].channel, 0u);
  EXPECT_EQ(read->points[0].f_per_sr, -1e-3);
  EXPECT_EQ(read->points[1].flags, 3u);
  EXPECT_EQ(read->flag_names, (std::vector<std::string>{"weak", "odd"}));
}

TEST(CsvFile, OfOthersMayHaveCommentsAndBlankLines) {
  const std::string csv =
      "# goniometer of another laboratory\r\n\r\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr\r\n"
      "10,0,20,0,1\r\n\r\n# lamp changed\r\n10,0,20,180,2\r\n  \r\n";

  const Result<MeasuredBrdf> read = read_csv(csv, std::nullopt, "theirs.csv");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->points.size(), 2u);
  EXPECT_EQ(read->points[1].f_per_sr, 2.0);
}

TEST(CsvFile, WithoutItsSidecarKeepsItsChannelsApart) {
  MeasuredBrdf brdf = odd_brdf();
  brdf.channels = {{.name = "R"}, channel_at(550.5), {.name = "B"}};
  for (std::size_t n = 0; n < brdf.points.size(); ++n) brdf.points[n].channel = static_cast<std::uint32_t>(n % 3);
  const Result<Export> written = write_csv(brdf);
  ASSERT_TRUE(written) << describe(written.error());

  const Result<MeasuredBrdf> read = read_csv(bytes_of(written, ".csv"), std::nullopt, "wheat.csv");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->channels, (std::vector<Channel>{{.name = "channel 0"}, channel_at(550.5), {.name = "channel 2"}}));
  for (std::size_t n = 0; n < brdf.points.size(); ++n) EXPECT_EQ(read->points[n].channel, n % 3);
}

struct BadCsv {
  std::string csv;
  int line;
  std::string says;
};

TEST(CsvFile, SaysWhereABadOneIsBad) {
  const std::string names = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr\n";
  const std::vector<BadCsv> rows{{"", 0, "an empty file"},
                                 {names, 1, ""},
                                 {"theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n", 1, "f_per_sr"},
                                 {names + "10,0,20,0,nan\n", 2, "f_per_sr"},
                                 {names + "10,0,20,0,inf\n", 2, "f_per_sr"},
                                 {names + "10,0,20,0,1\n10,0,20,0\n", 3, "4 cells"},
                                 {names + "10,0,20,0,1\n10,0,20,0,1", 3, "no end"},
                                 {names + "10,0,ninety,0,1\n", 2, "theta_r_deg"},
                                 {names + "10,0,90.5,0,1\n", 0, "theta_r_deg"},
                                 {"theta,phi\n", 1, "unknown column"},
                                 {"theta_i,phi_i\n", 1, "without its unit"},
                                 {"MERL\x01\x02", 1, "unknown column"}};
  for (const BadCsv& row : rows) {
    SCOPED_TRACE(row.csv);
    const Result<MeasuredBrdf> read = read_csv(row.csv, std::nullopt, "bad.csv");
    ASSERT_FALSE(read);
    const std::string said = describe(read.error());
    EXPECT_EQ(read.error().code, ErrorCode::InvalidInput);
    EXPECT_THAT(said, HasSubstr("bad.csv"));
    EXPECT_THAT(said, HasSubstr(row.says));
    if (row.line > 0 && !row.says.empty()) {
      EXPECT_EQ(read.error().where->line, row.line) << said;
    }
  }
}

TEST(CsvFile, CutAnywhereIsRefused) {
  const Result<Export> written = write_csv(bright_retro());
  const std::string& csv = bytes_of(written, ".csv");
  const std::string& sidecar = bytes_of(written, ".json");
  for (std::size_t length = 0; length < csv.size(); length += 97)
    EXPECT_FALSE(read_csv(csv.substr(0, length), sidecar, "cut.csv")) << length;
  for (std::size_t length = 0; length + 2 < sidecar.size(); length += 13)
    EXPECT_FALSE(read_csv(csv, sidecar.substr(0, length), "cut.csv")) << length;
}

TEST(CsvFile, RefusesASidecarOfAnotherFormatOrVersion) {
  const std::string csv = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr,channel\n10,0,20,0,1,0\n";
  for (const std::string sidecar :
       {R"({"format":"other","version":1,"points":1})", R"({"format":"gonio-brdf","version":2,"points":1})",
        R"({"format":"gonio-brdf","version":1,"points":-1})",
        R"({"format":"gonio-brdf","version":1,"points":1,"channels":[{}]})",
        R"({"format":"gonio-brdf","version":1,"points":1,"metadata":{"method":"guess"}})", R"([])", "{", "\xFF"}) {
    const Result<MeasuredBrdf> read = read_csv(csv, sidecar, "bad.json");
    ASSERT_FALSE(read) << sidecar;
    EXPECT_THAT(describe(read.error()), HasSubstr("bad.json"));
  }
}

TEST(CsvFile, RefusesAFlagNameThatItsColumnCannotHold) {
  MeasuredBrdf brdf = bright_retro();
  brdf.flag_names = {"near|zero"};

  EXPECT_FALSE(write_csv(brdf));
}

}  // namespace
}  // namespace gonio::formats
