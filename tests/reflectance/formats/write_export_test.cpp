#include "reflectance/formats/write_export.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/process.h"

namespace gonio::formats {
namespace {

TEST(WriteExport, PutsAllFilesOfAnExportBesideEachOther) {
  const test::TemporaryFolder folder;
  const Export written{
      .files = {{.suffix = ".csv", .bytes = std::string("a\0b", 3)}, {.suffix = ".json", .bytes = "{}"}}, .losses = {}};

  ASSERT_TRUE(write_export(folder / "wheat", written));

  EXPECT_EQ(test::text_of(folder / "wheat.csv"), std::string("a\0b", 3));
  EXPECT_EQ(test::text_of(folder / "wheat.json"), "{}");
}

TEST(WriteExport, EndsAtTheFirstFileThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "wheat.csv");
  const Export written{.files = {{.suffix = ".csv", .bytes = "a"}, {.suffix = ".json", .bytes = "{}"}}, .losses = {}};

  EXPECT_FALSE(write_export(folder / "wheat", written));

  EXPECT_FALSE(std::filesystem::exists(folder / "wheat.json"));
}

}  // namespace
}  // namespace gonio::formats
