#include "reflectance/formats/format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reflectance/formats/astm_file.h"
#include "reflectance/formats/bird_file.h"
#include "reflectance/formats/csv_file.h"
#include "reflectance/formats/klems_file.h"
#include "reflectance/formats/merl_file.h"
#include "reflectance/formats/nexus_file.h"
#include "reflectance/formats/pab_file.h"
#include "reflectance/formats/rgl_file.h"
#include "reflectance/formats/ssdd_file.h"
#include "reflectance/formats/utf8_text.h"
#include "reflectance/formats/zemax_file.h"
#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

using FileOfFormat = std::pair<Format, std::string>;

std::vector<FileOfFormat> make_one_of_each() {
  const MeasuredBrdf brdf = bright_retro();
  SurfaceFile file;
  file.channels.push_back({.channel = channel_at(550.0), .surface = reflectance::wheat()});
  return {{Format::Csv, bytes_of(write_csv(brdf), ".csv")},
          {Format::Bird, bytes_of(write_bird(brdf), ".brdf")},
          {Format::Astm, bytes_of(write_astm(brdf), ".astm")},
          {Format::Zemax, bytes_of(write_zemax(file), ".bsdf")},
          {Format::Merl, bytes_of(write_merl(file), ".binary")},
          {Format::Ssdd, bytes_of(write_ssdd(file), ".ssdd")},
          {Format::Pab, bytes_of(write_pab(brdf), "-30-0.dat")},
          {Format::Alta, "#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n0.5 0 0 5\n"},
          {Format::Klems, bytes_of(write_klems(file), ".xml")},
          {Format::Rgl, bytes_of(write_rgl(file, {.nodes = 8, .incidence_step_deg = 44.0}), ".bsdf")},
          {Format::Nexus, bytes_of(write_nexus(brdf), ".nxs")}};
}

const std::vector<FileOfFormat>& one_of_each() {
  static const std::vector<FileOfFormat> kFiles = make_one_of_each();  // MERL's has a million values
  return kFiles;
}

TEST(Format, IsKnownByWhatStandsInTheFile) {
  for (const auto& [format, bytes] : one_of_each()) {
    SCOPED_TRACE(format_name(format));
    ASSERT_FALSE(bytes.empty());
    EXPECT_EQ(detect_format(bytes), format);
    EXPECT_EQ(format_from_name(format_name(format)), format);
    const Result<MeasuredBrdf> read = read_brdf(bytes, "some.file");
    EXPECT_EQ(read.has_value(), is_readable(format)) << (read ? "" : describe(read.error()));
    if (!read) {
      EXPECT_THAT(describe(read.error()), HasSubstr("written only"));
    }
  }
  EXPECT_FALSE(is_writable(Format::Alta));
}

TEST(Format, OfATextIsKnownBehindAByteOrderMarkAndComments) {
  const std::string csv = "# by hand\r\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr\r\n10,0,20,0,1\r\n";
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(detect_format(mark + csv), Format::Csv);
  EXPECT_TRUE(read_brdf(mark + csv, "theirs.csv"));
  for (const auto& [format, bytes] : one_of_each()) {
    const bool is_text = format != Format::Merl && format != Format::Rgl && format != Format::Nexus;
    if (!is_text || !is_readable(format)) continue;
    EXPECT_EQ(detect_format(mark + bytes), format);
    EXPECT_TRUE(read_brdf(mark + bytes, "theirs")) << format_name(format);
  }
  const Result<MeasuredBrdf> wide = read_brdf("\xFF\xFEt", "theirs.csv");
  EXPECT_THAT(describe(wide.error()), HasSubstr("UTF-16"));
}

TEST(Format, OfOlderTextsHasItsLatinCharacters) {
  const std::string alta =
      "#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n#SAMPLE \"10 \xB5m\"\n.5 0 0 5\n";
  EXPECT_EQ(read_brdf(alta, "x.alta")->metadata.sample, "10 \xC2\xB5m");
  for (const std::string utf8 : {"", "10 \xC2\xB5m", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"})
    EXPECT_EQ(as_utf8(utf8), utf8);
  for (const std::string other : {"\xC0\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xE2\x82", "\xFF"}) {
    EXPECT_FALSE(is_utf8(other)) << "overlong, a surrogate, beyond the last, cut short, none";
    EXPECT_TRUE(is_utf8(as_utf8(other)));
  }
}

TEST(Format, ThatIsNoneHasItsWord) {
  for (const std::string bytes : {"", "hello", "{\"a\": 1}", "<html>", "\x89PNG\r\n", " \n\n"}) {
    EXPECT_FALSE(detect_format(bytes)) << bytes;
    const Result<MeasuredBrdf> read = read_brdf(bytes, "what.bin");
    ASSERT_FALSE(read);
    EXPECT_THAT(describe(read.error()), HasSubstr("what.bin"));
    EXPECT_THAT(describe(read.error()), HasSubstr("csv, bird, astm"));
  }
  EXPECT_FALSE(format_from_name("jpeg"));
}

// Each file under the name of each other format's reader: an error that names the file, never a crash or a wrong
// reading.
TEST(Format, OfAnotherKindIsRefusedByEveryReader) {
  for (const auto& [format, bytes] : one_of_each()) {
    SCOPED_TRACE(format_name(format));
    const std::vector<std::pair<Format, Result<MeasuredBrdf>>> tried{{Format::Csv, read_csv(bytes, std::nullopt, "x")},
                                                                     {Format::Bird, read_bird(bytes, "x")},
                                                                     {Format::Astm, read_astm(bytes, "x")},
                                                                     {Format::Zemax, read_zemax(bytes, "x")},
                                                                     {Format::Merl, read_merl(bytes, "x")},
                                                                     {Format::Ssdd, read_ssdd(bytes, "x")},
                                                                     {Format::Rgl, read_rgl(bytes, "x")},
                                                                     {Format::Nexus, read_nexus(bytes, "x")}};
    for (const auto& [reader, result] : tried)
      EXPECT_EQ(result.has_value(), reader == format) << "by the reader of " << format_name(reader);
  }
}

}  // namespace
}  // namespace gonio::formats
