#include "daemon/engine/file_limit.h"

#include <sys/resource.h>
#include <sys/select.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace gonio::daemon {

Result<void> limit_open_files() {
  rlimit limit{};
  int refused = getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = std::min<rlim_t>(FD_SETSIZE, limit.rlim_max);
  if (refused == 0) refused = setrlimit(RLIMIT_NOFILE, &limit);
  if (refused == 0) return {};
  return failure(
      {.code = ErrorCode::Internal, .tried = "limit the number of open files", .seen = std::strerror(errno)});
}

}  // namespace gonio::daemon
