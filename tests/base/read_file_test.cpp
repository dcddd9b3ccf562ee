#include "base/read_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace gonio {
namespace {

class ReadFile : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
};

TEST_F(ReadFile, GivesEveryByte) {
  std::string bytes(200000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 % 256);
  std::ofstream(folder_ / "bytes", std::ios::binary) << bytes;

  EXPECT_EQ(read_file(folder_ / "bytes").value(), bytes);
}

TEST_F(ReadFile, GivesNothingOfAnEmptyFile) {
  std::ofstream(folder_ / "empty").close();

  EXPECT_EQ(read_file(folder_ / "empty").value(), "");
}

TEST_F(ReadFile, SaysWhyThereIsNoText) {
  const Result<std::string> missing = read_file(folder_ / "missing");
  const Result<std::string> folder = read_file(folder_.path());

  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, ErrorCode::FileUnreadable);
  EXPECT_EQ(missing.error().seen, "No such file or directory");
  EXPECT_EQ(missing.error().where->file, folder_ / "missing");
  ASSERT_FALSE(folder.has_value());
  EXPECT_EQ(folder.error().code, ErrorCode::FileUnreadable);
  EXPECT_EQ(folder.error().seen, "Is a directory");
}

}  // namespace
}  // namespace gonio
