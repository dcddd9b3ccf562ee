#include "cli/sibling_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace gonio::cli {

namespace fs = std::filesystem;

std::string sibling_program(const std::string& name, const std::string& own_path) {
  return (fs::path(own_path).parent_path() / name).string();
}

std::string own_program() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).string();
}

Error become_program(const std::vector<std::string>& command, const std::string& tried) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  execv(words[0], words.data());
  return {.code = ErrorCode::FileUnreadable,
          .device = "gonioctl",
          .tried = tried,
          .seen = std::strerror(errno),
          .limit = {},
          .where = InputLocation{command[0], 0, {}}};
}

}  // namespace gonio::cli
