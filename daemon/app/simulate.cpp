#include "daemon/app/simulate.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>

namespace gonio::daemon {
namespace {

// Options of goniosim that may stand among ours, each with a value.
const std::set<std::string, std::less<>> kOfTheSimulator{"--seed", "--state", "--time-scale", "--modbus-port",
                                                         "--camera-address"};
constexpr const char* kUsualScene = "wheat";

}  // namespace

std::vector<std::string> simulation_command(const std::vector<std::string>& arguments, const std::string& own) {
  std::vector<std::string> simulator{(std::filesystem::path(own).parent_path() / "goniosim").string(), kUsualScene};
  std::vector<std::string> daemon{"--", own, "--instrument", "{state}/instrument.toml"};
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const bool has_value = i + 1 < arguments.size() && !arguments[i + 1].starts_with("--");
    if (word == "--simulate") {
      if (has_value) simulator[1] = arguments[++i];
    } else if (word == "--instrument") {
      if (has_value) ++i;
    } else if (kOfTheSimulator.contains(word) && has_value) {
      simulator.insert(simulator.end(), {word, arguments[++i]});
    } else {
      daemon.push_back(word);
    }
  }
  simulator.insert(simulator.end(), daemon.begin(), daemon.end());
  return simulator;
}

Error become(const std::vector<std::string>& command) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  execv(words[0], words.data());
  return {.code = ErrorCode::FileUnreadable,
          .device = "goniod",
          .tried = "start the simulator",
          .seen = std::strerror(errno),
          .where = InputLocation{command[0], 0, ""}};
}

std::string own_path() {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).string();
}

}  // namespace gonio::daemon
