#include "cli/replay_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace gonio::cli {

std::vector<std::string> replay_command(const ReplayLine& wanted, const std::string& own_path) {
  std::vector<std::string> command{
      (std::filesystem::path(own_path).parent_path() / "goniod").string(), "--replay",    wanted.tape, "--store",
      wanted.store.empty() ? wanted.tape + ".sqlite" : wanted.store,       "--log-level", "error"};
  if (!wanted.against.empty()) command.insert(command.end(), {"--against", wanted.against});
  if (!wanted.instrument.empty()) command.insert(command.end(), {"--instrument", wanted.instrument});
  return command;
}

Error become_replay(const ReplayLine& wanted) {
  std::error_code ignored;
  const std::vector<std::string> command =
      replay_command(wanted, std::filesystem::read_symlink("/proc/self/exe", ignored).string());
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  execv(words[0], words.data());
  return {.code = ErrorCode::FileUnreadable,
          .device = "gonioctl",
          .tried = "start goniod to replay",
          .seen = std::strerror(errno),
          .limit = {},
          .where = InputLocation{command[0], 0, {}}};
}

}  // namespace gonio::cli
