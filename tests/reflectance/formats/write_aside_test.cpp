#include "reflectance/formats/write_aside.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace gonio::formats {
namespace {

namespace fs = std::filesystem;

class WriteAside : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "gonio-formats-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string content(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(WriteAside, PutsAllFilesOfAnExportThereAndNothingElse) {
  const Export written{
      .files = {{.suffix = ".csv", .bytes = std::string("a\0b", 3)}, {.suffix = ".json", .bytes = "{}"}}, .losses = {}};

  ASSERT_TRUE(write_export((folder_ / "wheat").string(), written));

  EXPECT_EQ(content("wheat.csv"), std::string("a\0b", 3));
  EXPECT_EQ(content("wheat.json"), "{}");
  EXPECT_EQ(files(), 2u);
}

TEST_F(WriteAside, LeavesTheOldFileWhereTheNewOneCannotBeFinished) {
  ASSERT_TRUE(write_aside((folder_ / "old").string(), "old"));
  fs::create_directory(folder_ / "folder");
  std::ofstream(folder_ / "folder" / "full") << "x";

  const Result<void> over_folder = write_aside((folder_ / "folder").string(), "new");
  const Result<void> nowhere = write_aside((folder_ / "no" / "such").string(), "new");

  ASSERT_FALSE(over_folder);
  EXPECT_EQ(over_folder.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(describe(over_folder.error()), testing::HasSubstr("folder"));
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(content("old"), "old");
  EXPECT_EQ(files(), 2u) << "nothing half written is left";
}

}  // namespace
}  // namespace gonio::formats
