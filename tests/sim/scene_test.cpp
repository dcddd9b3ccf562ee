#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "sim/goniosim/find_scene.h"
#include "sim/scene/read_scene.h"
#include "sim/scene/truth.h"
#include "tests/support/process.h"

namespace gonio::sim::test {
namespace {

namespace fs = std::filesystem;
using gonio::test::TemporaryFolder;
using gonio::test::write_text;

const fs::path kScenes = GONIO_SCENES;

const std::string kSample = "[sample]\nmodel = \"lambertian\"\nrho = 0.5\n";

std::string scene_text(const std::string& head = {}, const std::string& rest = kSample) {
  return "[scene]\nname = \"x\"\nbench = \"" + (kScenes / "bench.toml").string() + "\"\n" + head + rest;
}

/// What reading this text says.
Result<Scene> read_text(const std::string& text) {
  const TemporaryFolder folder;
  write_text(folder / "x.toml", text);
  return read_scene(folder / "x.toml");
}

TEST(ReadScene, ReadsEverySceneThatIsShipped) {
  int scenes = 0;
  for (const auto& entry : fs::directory_iterator(kScenes)) {
    if (entry.path().stem() == "bench") continue;
    const auto scene = read_scene(entry.path().string());
    ASSERT_TRUE(scene.has_value()) << describe(scene.error());
    EXPECT_EQ(scene->name, entry.path().stem().string());
    ++scenes;
  }
  EXPECT_GE(scenes, 7);
}

TEST(ReadScene, MakesTheWheatOfTheNotes) {
  const auto scene = read_scene((kScenes / "wheat.toml").string());
  ASSERT_TRUE(scene.has_value());

  // Mobley (2005) eq 8 with the wheat parameters at (30, 60, 180).
  const Brdf f = Truth(*scene).sample({degrees(30.0), degrees(0.0), degrees(60.0), degrees(180.0)});

  EXPECT_NEAR(f.si(), 0.175707298205257, 1e-14);
}

// Rings of a canopy as a lab would hand them over: our CSV, without its sidecar.
std::string readings_csv() {
  std::string csv = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr,wavelength_nm\n";
  for (const int theta_i : {0, 30, 60}) {
    for (const int theta_r : {10, 30, 50, 70}) {
      for (int phi = 0; phi < 360; phi += 30) {
        const double f = 0.1 + 0.001 * theta_r + (theta_i == 30 && theta_r == 30 && phi == 60 ? 0.5 : 0.0);
        csv += std::to_string(theta_i) + ",0," + std::to_string(theta_r) + "," + std::to_string(phi) + "," +
               std::to_string(f) + ",550\n";
      }
    }
  }
  return csv;
}

TEST(ReadScene, TakesAMeasuredSurfaceFromTheFileBesideIt) {
  const TemporaryFolder folder;
  write_text(folder / "canopy.csv", readings_csv());
  write_text(folder / "x.toml", scene_text({}, "[sample]\nfile = \"canopy.csv\"\nchannel = \"550nm\"\n"));

  const auto scene = read_scene(folder / "x.toml");

  ASSERT_TRUE(scene.has_value()) << describe(scene.error());
  const Truth truth(*scene);
  EXPECT_NEAR(truth.sample({degrees(30.0), degrees(0.0), degrees(30.0), degrees(60.0)}).si(), 0.63, 1e-9);
  EXPECT_NEAR(truth.sample({degrees(30.0), degrees(0.0), degrees(50.0), degrees(270.0)}).si(), 0.15, 1e-9);
}

TEST(ReadScene, SaysWhatIsWrongWithAMeasuredSurface) {
  const TemporaryFolder folder;
  write_text(folder / "canopy.csv", readings_csv());
  write_text(folder / "poem.csv", "No BRDF at all.\n");
  const auto refused = [&](const std::string& sample) {
    write_text(folder / "x.toml", scene_text({}, "[sample]\n" + sample));
    return read_scene(folder / "x.toml").error();
  };

  EXPECT_EQ(refused("file = \"none.csv\"\n").code, ErrorCode::FileUnreadable);
  EXPECT_EQ(refused("file = \"poem.csv\"\n").code, ErrorCode::InvalidInput);
  const Error channel = refused("file = \"canopy.csv\"\nchannel = \"600nm\"\n");
  EXPECT_THAT(channel.seen, testing::HasSubstr("no channel \"600nm\""));
  EXPECT_EQ(channel.where->field, "sample.file");
}

TEST(ReadScene, NamesTheUnknownKeyItsLineAndTheNearestName) {
  const auto scene = read_text(scene_text("time_scal = 40.0\n"));

  ASSERT_FALSE(scene.has_value());
  EXPECT_EQ(scene.error().code, ErrorCode::UnknownKey);
  EXPECT_EQ(scene.error().where->line, 4);
  EXPECT_THAT(scene.error().limit, testing::HasSubstr("time_scale"));
}

TEST(ReadScene, NamesTheParameterThatAModelDoesNotTake) {
  const auto wrong = read_text(scene_text({}, "[sample]\nmodel = \"lambertian\"\nrho = 0.5\nroh = 0.5\n"));
  const auto beyond = read_text(scene_text({}, "[sample]\nmodel = \"lambertian\"\nrho = 1.5\n"));
  const auto nothing = read_text(scene_text({}, "[sample]\nmodel = \"lambertain\"\n"));

  ASSERT_FALSE(wrong.has_value());
  EXPECT_EQ(wrong.error().code, ErrorCode::UnknownKey);
  ASSERT_FALSE(beyond.has_value());
  EXPECT_EQ(beyond.error().where->field, "sample.rho");
  ASSERT_FALSE(nothing.has_value());
  EXPECT_EQ(nothing.error().where->field, "sample.model");
}

TEST(ReadScene, TakesASectionOfItsOwnInsteadOfTheBenchs) {
  const auto scene = read_text(scene_text({}, kSample + "[source]\npower = 3.0\n"));

  ASSERT_TRUE(scene.has_value()) << describe(scene.error());
  EXPECT_EQ(scene->lamp.power, 3.0);
  EXPECT_EQ(scene->lamp.flicker, 0.0) << "what it does not name is off, whatever the bench says";
  EXPECT_EQ(scene->detector.electrons_per_dn, 4.0) << "the rest is the bench's";
}

TEST(ReadScene, RefusesASceneWithoutASection) {
  const auto scene = read_text("[scene]\nname = \"x\"\n" + kSample);

  ASSERT_FALSE(scene.has_value());
  EXPECT_EQ(scene.error().code, ErrorCode::MissingKey);
  EXPECT_EQ(scene.error().where->field, "source");
}

TEST(ReadScene, SaysThatItsBenchIsNotThere) {
  const auto scene = read_text("[scene]\nname = \"x\"\nbench = \"nowhere.toml\"\n" + kSample);

  ASSERT_FALSE(scene.has_value());
  EXPECT_EQ(scene.error().code, ErrorCode::FileUnreadable);
}

TEST(FindScene, TakesAFileOrANameBesideTheExecutable) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "scenes");
  write_text(folder / "scenes/grass.toml", "");
  write_text(folder / "scenes/bench.toml", "");
  write_text(folder / "own.toml", "");

  EXPECT_EQ(find_scene(folder / "own.toml", folder / "goniosim").value(), folder / "own.toml");
  EXPECT_EQ(find_scene("grass", folder / "goniosim").value(), folder / "scenes/grass.toml");
  const auto unknown = find_scene("weath", folder / "goniosim");
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().limit, "one of: grass");
}

}  // namespace
}  // namespace gonio::sim::test
