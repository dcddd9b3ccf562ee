#include "daemon/engine/file_limit.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>

namespace gonio::daemon {
namespace {

TEST(FileLimit, LeavesNoDescriptorThatSelectCannotHold) {
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);

  const auto limited = limit_open_files();

  ASSERT_TRUE(limited) << describe(limited.error());
  rlimit after{};
  getrlimit(RLIMIT_NOFILE, &after);
  EXPECT_EQ(after.rlim_cur, std::min<rlim_t>(1024, before.rlim_max));
  EXPECT_EQ(after.rlim_max, before.rlim_max);
  setrlimit(RLIMIT_NOFILE, &before);
}

}  // namespace
}  // namespace gonio::daemon
