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
