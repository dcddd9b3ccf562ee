#include "reflectance/formats/write_export.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>
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

// A file may grow to this many bytes, as on a disk that is full behind them.
class SizeLimit {
 public:
  explicit SizeLimit(rlim_t most) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit lower{.rlim_cur = most, .rlim_max = before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &lower);
  }
  ~SizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

TEST(WriteExport, ThatFailsWithinItsSecondFileLeavesTheOldPairAsItWas) {
  const test::TemporaryFolder folder;
  const Export old{.files = {{.suffix = ".csv", .bytes = "old"}, {.suffix = ".json", .bytes = "{}"}}, .losses = {}};
  ASSERT_TRUE(write_export(folder / "wheat", old));
  const Export larger{
      .files = {{.suffix = ".csv", .bytes = "new"}, {.suffix = ".json", .bytes = std::string(100'000, ' ')}},
      .losses = {}};
  {
    const SizeLimit full(10'000);
    EXPECT_FALSE(write_export(folder / "wheat", larger));
  }

  EXPECT_EQ(test::text_of(folder / "wheat.csv"), "old") << "a new table beside an old sidecar belongs to nothing";
  EXPECT_EQ(test::text_of(folder / "wheat.json"), "{}");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2) << "nothing half written is left";
}

}  // namespace
}  // namespace gonio::formats
