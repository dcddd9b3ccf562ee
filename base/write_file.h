#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace gonio {

/// Writes `path`.part-PID, makes it durable (fsync of file and folder), then renames: the file is there whole or as it
/// was. With `keep_old_as` the text that it replaces keeps that name too. Blocks for the disk. Errors: DiskFull,
/// InvalidInput (any other reason), each with the system's word, at `path`. Threads: any, for different paths.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view bytes,
                                      const std::string& keep_old_as = {});

struct FileToWrite {
  std::string path;
  std::string_view bytes;
};

/// Files that belong together: all are written aside and made durable before the first is renamed, so that a full disk
/// leaves every one as it was. Errors and threads as above; only a rename that fails after another (a path that became
/// a folder meanwhile, a disk that is lost) can part them.
[[nodiscard]] Result<void> write_files(const std::vector<FileToWrite>& files);

}  // namespace gonio
