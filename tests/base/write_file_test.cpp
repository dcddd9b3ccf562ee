#include "base/write_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>

#include "tests/support/process.h"

namespace gonio {
namespace {

namespace fs = std::filesystem;

class WriteFile : public testing::Test {
 protected:
  std::string content(const std::string& name) const { return test::text_of(folder_ / name); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }

  test::TemporaryFolder folder_;
};

TEST_F(WriteFile, PutsEveryByteThereAndNothingElse) {
  const std::string bytes("a\0b", 3);

  ASSERT_TRUE(write_file(folder_ / "wheat.csv", bytes));

  EXPECT_EQ(content("wheat.csv"), bytes);
  EXPECT_EQ(files(), 1u);
}

TEST_F(WriteFile, LeavesTheOldFileWhereTheNewOneCannotBeFinished) {
  ASSERT_TRUE(write_file(folder_ / "old", "old"));
  fs::create_directory(folder_ / "folder");
  test::write_text(folder_ / "folder/full", "x");

  const Result<void> over_folder = write_file(folder_ / "folder", "new");
  const Result<void> nowhere = write_file(folder_ / "no/such", "new");

  ASSERT_FALSE(over_folder);
  EXPECT_EQ(over_folder.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(describe(over_folder.error()), testing::HasSubstr("folder"));
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(content("old"), "old");
  EXPECT_EQ(files(), 2u) << "nothing half written is left";
}

TEST_F(WriteFile, KeepsTheOldTextUnderAnotherName) {
  ASSERT_TRUE(write_file(folder_ / "white.toml", "old"));

  ASSERT_TRUE(write_file(folder_ / "white.toml", "new", folder_ / "white.toml.until-now"));

  EXPECT_EQ(content("white.toml"), "new");
  EXPECT_EQ(content("white.toml.until-now"), "old");
}

}  // namespace
}  // namespace gonio
