#include "base/read_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace gonio {
namespace {

class ReadFile : public testing::Test {
 protected:
  ReadFile() { std::filesystem::create_directory(folder_); }
  ~ReadFile() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "gonio-read-file";
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
  const Result<std::string> folder = read_file(folder_);

  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, ErrorCode::FileUnreadable);
  EXPECT_EQ(missing.error().seen, "No such file or directory");
  EXPECT_EQ(missing.error().where->file, (folder_ / "missing").string());
  ASSERT_FALSE(folder.has_value());
  EXPECT_EQ(folder.error().code, ErrorCode::FileUnreadable);
  EXPECT_EQ(folder.error().seen, "Is a directory");
}

}  // namespace
}  // namespace gonio
