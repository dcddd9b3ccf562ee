#include "reflectance/formats/bird_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>

#include <nlohmann/json.hpp>

#include "tests/reflectance/formats/bird_checker.h"
#include "tests/reflectance/formats/json_schema.h"
#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/formats/shared_data.h"

namespace gonio::formats {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

MeasuredBrdf two_channels() {
  MeasuredBrdf brdf = bright_retro();
  brdf.channels = {channel_at(550.0), channel_at(650.5)};
  brdf.channels[0].incident = brdf.channels[1].incident = Polarisation::S;
  brdf.channels[0].reflected = brdf.channels[1].reflected = Polarisation::Unpolarised;
  brdf.flag_names = {"near-zero", "few-neighbours"};
  brdf.points[5] = {.theta_i_deg = 12.345678901234567,
                    .phi_i_deg = 359.9,
                    .theta_r_deg = 1.0 / 3.0,
                    .phi_r_deg = 17.0,
                    .f_per_sr = -0.00123,
                    .U_per_sr = 0.002,
                    .k = 2.13,
                    .u_shared_per_sr = 0.0005,
                    .channel = 1,
                    .flags = 3};
  return brdf;
}

MeasuredBrdf with_all_metadata() {
  MeasuredBrdf brdf = two_channels();
  brdf.metadata = {.id = "urn:uuid:6f2d1a08-0000-4000-8000-000000000001",
                   .description = "wheat at noon",
                   .method = Method::Simulation,
                   .measured_at = "2026-01-01T12:00:00Z",
                   .software = "goniod 0.1",
                   .sample = "wheat",
                   .sample_kind = "canopy",
                   .zero_azimuth = "along the rows",
                   .symmetry = reflectance::TableSymmetry::Turn,
                   .medium = "air",
                   .temperature_c = 21.5,
                   .instrument = "gonio 1",
                   .beam_area_mm2 = 78.5,
                   .detector_solid_angle_sr = 0.002,
                   .references = {"SRS-99 0412"},
                   .organisation = "a laboratory",
                   .operator_name = "someone",
                   .email = "someone@example.org",
                   .country = "Finland",
                   .city = "Espoo",
                   .street = "Maarintie",
                   .building = "8",
                   .postal_code = "02150",
                   .remarks = {{"lamp", "xenon"}}};
  return brdf;
}

TEST(BirdFile, GivesBackWhatItWasGiven) {
  for (const MeasuredBrdf& brdf : {two_channels(), with_all_metadata(), bright_aside()}) {
    const Result<Export> written = write_bird(brdf);
    ASSERT_TRUE(written) << describe(written.error());
    const Result<MeasuredBrdf> read = read_bird(bytes_of(written, ".brdf"), "wheat.brdf");

    ASSERT_TRUE(read) << describe(read.error());
    EXPECT_EQ(read->points, brdf.points);
    EXPECT_EQ(read->channels, brdf.channels);
    EXPECT_EQ(read->flag_names, brdf.flag_names);
    EXPECT_EQ(read->metadata, brdf.metadata);
  }
}

TEST(BirdFile, ShowsANegativeValueAsZeroAndSaysSo) {
  const Result<Export> written = write_bird(two_channels());
  const json file = json::parse(bytes_of(written, ".brdf"));

  EXPECT_EQ(file["data"]["BRDF"]["values"][5], 0.0);
  EXPECT_EQ(file["data"]["adhoc_variables"]["f_signed"]["values"][5], -0.00123);
  ASSERT_EQ(written->losses.size(), 1u);
  EXPECT_EQ(written->losses[0].kind, LossKind::Sign);
  EXPECT_EQ(written->losses[0].values, 1u);
}

TEST(BirdFile, LeavesOutTheHorizonAndSaysSo) {
  MeasuredBrdf brdf = bright_retro();
  brdf.points[7].theta_r_deg = -90.0;

  const Result<Export> written = write_bird(brdf);

  EXPECT_TRUE(has_loss(written->losses, LossKind::PointsDropped));
  EXPECT_EQ(json::parse(bytes_of(written, ".brdf"))["data"]["BRDF"]["values"].size(), brdf.points.size() - 1);
  brdf.points = {brdf.points[7]};
  EXPECT_FALSE(write_bird(brdf));
}

// Read by the schema's words alone: parallel arrays in degrees, Nicodemus' directions.
TEST(BirdFile, HoldsTheBrightReadingWhereItWas) {
  const json file = json::parse(bytes_of(write_bird(bright_retro()), ".brdf"));
  const json& data = file["data"];
  const std::vector<double> f = data["BRDF"]["values"];
  const auto n = static_cast<std::size_t>(std::ranges::max_element(f) - f.begin());

  EXPECT_EQ(f[n], 5.0);
  EXPECT_EQ(data["theta_i"]["values"][n], 30.0);
  EXPECT_EQ(data["phi_i"]["values"][n], 0.0);
  EXPECT_EQ(data["theta_r"]["values"][n], 30.0);
  EXPECT_EQ(data["phi_r"]["values"][n], 0.0);
  EXPECT_EQ(data["theta_i"]["unit"], "deg");
  EXPECT_EQ(data["wavelength_i"]["values"][n], 550.0);
}

TEST(BirdFile, PassesThePublishedSchema) {
  const std::filesystem::path folder = shared_folder() / "schemas/bird";
  const JsonSchemas schemas(folder);
  if (schemas.is_empty()) {
    std::cout << "no BiRD schema in " << folder << ": nothing checked\n";
    return;
  }
  ASSERT_THAT(schemas.problems("/brdf_json_schema", json::parse(*file_content(folder / "example.brdf"))), IsEmpty());
  for (const MeasuredBrdf& brdf : {two_channels(), with_all_metadata(), bright_aside()}) {
    json file = json::parse(bytes_of(write_bird(brdf), ".brdf"));
    EXPECT_THAT(schemas.problems("/brdf_json_schema", file), IsEmpty());
    file["data"]["BRDF"]["values"][0] = -1.0;
    EXPECT_EQ(schemas.problems("/brdf_json_schema", file).size(), 1u) << "the checker sees what is wrong";
  }
}

TEST(BirdFile, PassesAjvAndABrokenOneDoesNot) {
  const test::TemporaryFolder folder;
  std::vector<std::string> good;
  for (const MeasuredBrdf& brdf : {two_channels(), with_all_metadata(), bright_aside()}) {
    good.push_back(folder / (std::to_string(good.size()) + ".brdf"));
    test::write_text(good.back(), bytes_of(write_bird(brdf), ".brdf"));
  }
  json negative = json::parse(bytes_of(write_bird(bright_aside()), ".brdf"));
  json nameless = negative;
  negative["data"]["BRDF"]["values"][0] = -1.0;
  nameless.erase("metadata");
  test::write_text(folder / "negative.brdf", negative.dump());
  test::write_text(folder / "nameless.brdf", nameless.dump());

  const auto on_good = checked_by_ajv(good, folder.path());
  const auto on_broken = checked_by_ajv({folder / "negative.brdf", folder / "nameless.brdf"}, folder.path());

  if (!on_good) {
    std::cout << "no BiRD schema in " << shared_folder() << ": nothing checked\n";
    return;
  }
  EXPECT_EQ(on_good->exit_code, 0) << on_good->output << on_good->errors;
  EXPECT_EQ(on_broken->exit_code, 1) << on_broken->output << on_broken->errors;
  EXPECT_THAT(on_broken->output, HasSubstr("negative.brdf [{\"instancePath\":\"/data/BRDF/values/0\""));
  EXPECT_THAT(on_broken->output, HasSubstr("must have required property 'metadata'"));
}

TEST(BirdFile, OfOthersIsRead) {
  const std::optional<std::string> example = file_content(shared_folder() / "schemas/bird/example.brdf");
  if (!example) {
    std::cout << "no BiRD example in " << shared_folder() << ": nothing checked\n";
    return;
  }
  const Result<MeasuredBrdf> read = read_bird(*example, "example.brdf");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->metadata.sample, "SRT1");
  EXPECT_EQ(read->metadata.symmetry, reflectance::TableSymmetry::Isotropic);
  EXPECT_EQ(read->metadata.temperature_c, 23.2);
  EXPECT_EQ(read->points[0].f_per_sr, 0.254);
  EXPECT_EQ(read->points[0].phi_r_deg, 60.0);
  ASSERT_EQ(read->channels.size(), 8u) << "four wavelengths, two polarisations";
  EXPECT_EQ(read->channels[2].wavelength_nm, 650.0);
  EXPECT_EQ(read->channels[1].name, "550nm incident [1,-1,0,0]");
}

TEST(BirdFile, TakesRadiansAndPercent) {
  json file = json::parse(bytes_of(write_bird(bright_retro()), ".brdf"));
  file["data"]["theta_r"] = {{"unit", "rad"}, {"values", std::vector<double>(bright_retro().points.size(), 0.5)}};
  file["data"]["uBRDF"]["unit"] = "%";
  file["data"].erase("adhoc_variables");
  file["metadata"].erase("adhoc_section");

  const Result<MeasuredBrdf> read = read_bird(file.dump(), "x.brdf");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_NEAR(read->points[0].theta_r_deg, 28.64788975654116, 1e-12);
  EXPECT_NEAR(read->points[0].U_per_sr, 0.1 * 0.01 * 0.01, 1e-15);
}

TEST(BirdFile, SaysWhereABadOneIsBad) {
  const json good = json::parse(bytes_of(write_bird(bright_retro()), ".brdf"));
  const auto said = [](const json& file) {
    const Result<MeasuredBrdf> read = read_bird(file.dump(), "bad.brdf");
    return read ? std::string("it was read") : describe(read.error());
  };
  json bad = good;
  bad["data"]["phi_r"]["values"].erase(0);
  EXPECT_THAT(said(bad), HasSubstr("data.phi_r.values"));
  bad = good;
  bad["data"]["theta_i"]["values"][3] = 90.0;
  EXPECT_THAT(said(bad), HasSubstr("data.theta_i.values[3]"));
  bad = good;
  bad["data"]["BRDF"]["values"][3] = nullptr;
  EXPECT_THAT(said(bad), HasSubstr("null"));
  bad = good;
  bad["data"]["theta_i"]["unit"] = "gon";
  EXPECT_THAT(said(bad), HasSubstr("gon"));
  bad = good;
  bad["data"].erase("BRDF");
  EXPECT_THAT(said(bad), HasSubstr("data.BRDF"));
  bad = good;
  for (const char* key : {"theta_i", "phi_i", "theta_r", "phi_r", "BRDF"}) bad["data"][key]["values"] = json::array();
  bad["data"].erase("adhoc_variables");
  bad["metadata"].erase("adhoc_section");
  bad["data"].erase("wavelength_i");
  bad["data"].erase("uBRDF");
  EXPECT_THAT(said(bad), HasSubstr("no points"));
  EXPECT_THAT(said(json::array()), HasSubstr("bad.brdf"));

  const std::string text = good.dump(1);
  for (std::size_t length = 0; length < text.size(); length += 499)
    EXPECT_FALSE(read_bird(text.substr(0, length), "cut.brdf")) << length;
  EXPECT_GT(read_bird(text.substr(0, 1000), "cut.brdf").error().where->line, 10);
}

}  // namespace
}  // namespace gonio::formats
