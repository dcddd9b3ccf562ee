// Files as other programs and people write them: read for what they say, or refused with a plain word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reflectance/formats/format.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

struct Stranger {
  const char* what;
  std::string bytes;
};

// Each of them holds one reading: 0.25 sr^-1 under 30 deg, seen from 45 deg at 60 deg.
void expect_the_reading(const Stranger& file) {
  SCOPED_TRACE(file.what);
  const Result<MeasuredBrdf> read = read_brdf(file.bytes, "theirs");
  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_FALSE(read->points.empty());
  const BrdfPoint& point = read->points.front();
  EXPECT_NEAR(point.theta_i_deg, 30.0, 1e-4);
  EXPECT_NEAR(point.theta_r_deg, 45.0, 1e-4);
  EXPECT_NEAR(point.phi_r_deg, 60.0, 1e-4);
  EXPECT_NEAR(point.f_per_sr, 0.25, 1e-12);
}

void expect_word(const Stranger& file, const char* word) {
  SCOPED_TRACE(file.what);
  const Result<MeasuredBrdf> read = read_brdf(file.bytes, "theirs");
  ASSERT_FALSE(read);
  EXPECT_THAT(describe(read.error()), HasSubstr("theirs"));
  EXPECT_THAT(describe(read.error()), HasSubstr(word));
}

TEST(StrangersFiles, OfCommaSeparatedValuesAreRead) {
  const std::string names = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr";
  for (const Stranger& file :
       {Stranger{"blanks behind commas",
                 "theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg, f_per_sr\n30, 0, 45, 60, 0.25\n"},
        Stranger{
            "in quotation marks",
            "\"theta_i_deg\",\"phi_i_deg\",\"theta_r_deg\",\"phi_r_deg\",\"f_per_sr\"\r\n\"30\",0,45,60,2.5e-01\r\n"},
        Stranger{"semicolons", "theta_i_deg;phi_i_deg;theta_r_deg;phi_r_deg;f_per_sr\n30;0;45;60;0.25\n"},
        Stranger{"semicolons and decimal commas",
                 "\xEF\xBB\xBFtheta_i_deg;phi_i_deg;theta_r_deg;phi_r_deg;f_per_sr\r\n30,0;0,0;45,0;60,0;0,25\r\n"},
        Stranger{"a spreadsheet's word on its separator",
                 "sep=;\r\ntheta_i_deg;phi_i_deg;theta_r_deg;phi_r_deg;f_per_sr\r\n30;0;45;60;0,25\r\n"},
        Stranger{"rows closed by a separator",
                 "theta_i_deg;phi_i_deg;theta_r_deg;phi_r_deg;f_per_sr;\n30;0;45;60;0,25;\n"},
        Stranger{"tabs", "theta_i_deg\tphi_i_deg\ttheta_r_deg\tphi_r_deg\tf_per_sr\tflags\n30\t0\t45\t60\t0.25\t\n"},
        Stranger{"units in brackets",
                 "Theta_i [deg],Phi_i [deg],Theta_r [deg],Phi_r [deg],BRDF [1/sr]\n30,0,45,60,0.25\n"},
        Stranger{"degree signs, s for scattered",
                 "theta_i (\xC2\xB0),phi_i (\xC2\xB0),theta_s (\xC2\xB0),phi_s (\xC2\xB0),brdf\n"
                 "30,0,45,60,0.25\n"},
        Stranger{"radians, another order",
                 "BRDF,phi_o [rad],theta_o [rad],phi_i [rad],theta_i [rad]\n"
                 "0.25,1.0471975511965976,0.7853981633974483,0,0.5235987755982988\n"},
        Stranger{"comments", "# lab 3\n#\n" + names + "\n\n# first\n30,0,45,60,0.25\n"}}) {
    expect_the_reading(file);
  }
}

TEST(StrangersFiles, SayTheirWavelengthInTheirUnit) {
  const Result<MeasuredBrdf> read = read_brdf(
      "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,brdf,lambda (um)\n30,0,45,60,0.25,1.55\n30,0,45,60,0.5,0.633\n",
      "x");
  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_EQ(read->channels.size(), 2u);
  EXPECT_NEAR(read->channels[0].wavelength_nm, 1550.0, 1e-9);
}

TEST(StrangersFiles, OfCommaSeparatedValuesThatLeaveADoubtAreRefused) {
  const std::string names = "theta_i_deg;phi_i_deg;theta_r_deg;phi_r_deg;f_per_sr\n";
  expect_word({"an angle without unit", "theta_i,phi_i,theta_r,phi_r,brdf\n30,0,45,60,0.25\n"}, "without its unit");
  expect_word({"thousands and decimals", names + "30;0;45;60;1.234,5\n"}, "'1.234,5'");
  expect_word({"two decimal commas", names + "30;0;45;60;1,234,5\n"}, "a finite number");
  expect_word(
      {"decimal commas between commas", "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr\n30,0,45,60,0,25\n"},
      "6 cells");
  expect_word(
      {"an uncertainty of unknown kind", "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,brdf,uBRDF\n30,0,45,60,1,0.1\n"},
      "an unknown column");
  expect_word({"the same column under two names",
               "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,brdf,theta_s [deg]\n30,0,45,60,1,45\n"},
              "stands twice");
}

TEST(StrangersFiles, OfAstmAreRead) {
  const std::string row = "0.5235987755982988,0,0.7853981633974483,1.0471975511965976,0.25";
  for (const Stranger& file :
       {Stranger{"as Cornell writes it",
                 "ASTM E1392-96(2002)\nSAMPLE paint\nNUM_POINTS 1\nVARS theta_i,phi_i,theta_s,phi_s,R\n" + row + "\n"},
        Stranger{"without a count, CR LF", "VARS theta_i,phi_i,theta_s,phi_s,R\r\n" + row + "\r\n"},
        Stranger{"a tab behind VARS, blanks behind commas",
                 "ASTM\nVARS\ttheta_i, phi_i, theta_s, phi_s, 550nm\n" + row + "\n"},
        Stranger{"blanks alone",
                 "ASTM E1392\nVARS theta_i phi_i theta_s phi_s R\n"
                 "0.523599 0 0.785398 1.047198 0.25\n"},
        Stranger{"r for s", "ASTM E1392\nVARS theta_i,phi_i,theta_r,phi_r,Red,Green,Blue\n" + row + ",1,2\n\n"}}) {
    expect_the_reading(file);
  }
  expect_word({"degrees", "VARS theta_i,phi_i,theta_s,phi_s,R\n30,0,45,60,0.25\n"}, "theta_i_deg");
}

TEST(StrangersFiles, OfAltaAreRead) {
  const std::string row = "0.5235987755982988 0 0.7853981633974483 1.0471975511965976 0.25";
  const std::string header = "#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n";
  for (const Stranger& file : {Stranger{"the bare header", header + row + "\n"},
                               Stranger{"a framed header",
                                        "#ALTA HEADER BEGIN\n#DIM 4 1\n#PARAM_IN  SPHERICAL_TL_PL_TV_PV\n#PARAM_OUT "
                                        "INV_STERADIAN\n#VERSION 1\n#FORMAT TEXT\n#ALTA HEADER END\n" +
                                            row + "\n"},
                               Stranger{"tabs, CR LF, comments",
                                        "#DIM 4 1\r\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\r\n# a comment\r\n\r\n"
                                        "0.5235987755982988\t0\t0.7853981633974483\t1.0471975511965976\t2.5e-1\r\n"}}) {
    expect_the_reading(file);
  }
  expect_word({"binary", header + "#FORMAT binary\n#SAMPLE_COUNT 1\n\x01\x02\x03\x04"}, "FORMAT");
  expect_word({"another parameterisation", "#DIM 2 1\n#PARAM_IN COS_TH_TD\n0.5 0.5 1\n"}, "COS_TH_TD");
}

TEST(StrangersFiles, OfZemaxAreRead) {
  const std::string rest =
      "SampleRotation\t1\r\n0\r\nAngleOfIncidence\t1\r\n30\r\nScatterAzimuth\t2\r\n0\t180\r\n"
      "ScatterRadial 3\r\n0 10 20\r\n\r\nMonochrome\r\nDataBegin\r\nTIS\t0.5\r\n"
      "5.0e-1 2.5E-01 +0.1\r\n0.5\t0.25\t0.1\t\r\nDataEnd\r\n";
  for (const char* symmetry : {"PlaneSymmetrical", "Asymmetrical", "ASymmetrical", "ASymmetrical4D"}) {
    SCOPED_TRACE(symmetry);
    const Result<MeasuredBrdf> read =
        read_brdf(std::string("#BSDF of a lab\r\n\r\n# Sample: paint \r\nSource Measured\r\nSymmetry  ") + symmetry +
                      "\r\nSpectralContent  Monochrome\r\nScatterType  BRDF\r\n" + rest,
                  "theirs");
    ASSERT_TRUE(read) << describe(read.error());
    EXPECT_EQ(read->metadata.sample, "paint");
    ASSERT_EQ(read->points.size(), 5u) << "the middle once";
    EXPECT_EQ(read->points[0].f_per_sr, 0.5);
    EXPECT_NEAR(read->points[0].theta_r_deg, 30.0, 1e-9);
  }
  expect_word({"what goes through",
               "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BTDF\n" + rest},
              "BTDF");
}

TEST(StrangersFiles, OfSsddAreRead) {
  const auto text = [](const std::string& end) {
    return "VERSION  0.2" + end + "SOURCE_TYPE measured" + end + "NAME a paint" + end + "DATA_TYPE brdf" + end +
           "COLOR_MODEL monochrome" + end + "WAVELENGTH_UNIT nanometer" + end +
           "PARAM_TYPE spherical_coordinate_system" + end + end + "PARAM0_LIST 30" + end + "PARAM1_LIST 0" + end +
           "PARAM2_LIST 45 50" + end + "PARAM3_LIST 60" + end + "DATA ascii" + end + "0.25" + end + " 0.5 " + end;
  };
  for (const char* end : {"\n", "\r\n"}) {
    const Result<MeasuredBrdf> read = read_brdf(text(end), "theirs");
    ASSERT_TRUE(read) << describe(read.error());
    ASSERT_EQ(read->points.size(), 2u);
    EXPECT_EQ(read->points[0].theta_i_deg, 30.0);
    EXPECT_EQ(read->points[0].f_per_sr, 0.25);
  }
  expect_word({"what goes through", "VERSION 0.2\nDATA_TYPE btdf\nDATA ascii\n1\n"}, "btdf");
  expect_word({"a list that is short of an angle", text("\n") + "0.75\n"}, "more values than PARAM0_LIST");
}

std::string bird_text(const std::string& data) {
  return "\xEF\xBB\xBF{\r\n  \"data\": {" + data +
         R"(, "phi_i": {"unit": "deg", "values": [0]}, "theta_r": {"values": [45.0], "unit": "deg"},
             "phi_r": {"unit": "\u00b0", "values": [60]}},
            "metadata": {"type": "BRDF", "sample": {"name": "paint"}, "instrumentation": "NA", "environment": "NA",
                         "a_laboratory's_own": [1, {"x": null}]}})";
}

TEST(StrangersFiles, OfBirdAreRead) {
  const std::string theta_i = R"("theta_i": {"unit": "deg", "values": [3e1]})";
  for (const Stranger& file :
       {Stranger{"data first, no uncertainty", bird_text(theta_i + R"(, "BRDF": {"unit": "1/sr", "values": [0.25]})")},
        Stranger{"a unit that is left out", bird_text(theta_i + R"(, "BRDF": {"values": [0.25]})")},
        Stranger{"its uncertainty in percent, a wavelength",
                 bird_text(theta_i + R"(, "BRDF": {"unit": "sr^-1", "values": [0.25]},
                   "uBRDF": {"unit": "%", "values": [2]}, "wavelength_i": {"unit": "nm", "values": [550]})")}}) {
    expect_the_reading(file);
  }
  expect_word({"no number, as Python writes it", bird_text(theta_i + R"(, "BRDF": {"values": [NaN]})")}, "NaN");
  expect_word({"infinity, as Python writes it", bird_text(theta_i + R"(, "BRDF": {"values": [-Infinity]})")},
              "Infinity, which is no number");
  expect_word({"nothing", bird_text(theta_i + R"(, "BRDF": {"values": [null]})")}, "data.BRDF.values[0]");
  expect_word({"a number in quotation marks", bird_text(theta_i + R"(, "BRDF": {"values": ["0.25"]})")},
              "data.BRDF.values[0]");
  expect_word({"a value more", bird_text(theta_i + R"(, "BRDF": {"values": [0.25, 0.5]})")}, "2 values");
  expect_word({"an angle without unit", bird_text(R"("theta_i": {"values": [30]}, "BRDF": {"values": [0.25]})")},
              "data.theta_i.unit");
}

TEST(StrangersFiles, OfOtherKindsAreNamed) {
  expect_word({"UTF-16 of a spreadsheet", std::string("\xFF\xFEt\0h\0", 6)}, "UTF-16");
  expect_word({"a spreadsheet itself", "PK\x03\x04 xl/workbook.xml"}, "none of the formats");
  expect_word({"a page", "<!DOCTYPE html><html></html>\n"}, "none of the formats");
  expect_word({"columns under other names", "incidence;view;azimuth;value\n30;45;60;0.25\n"},
              "'incidence;view;azimuth;value' are columns of a CSV, its first line must name theta_i_deg");
  expect_word({"numbers alone", "30 0 45 60 0.25\n30 0 45 90 0.25\n"}, "must name theta_i_deg");
}

}  // namespace
}  // namespace gonio::formats
