#include "sim/goniosim/child.h"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace gonio::sim {
namespace {

std::string with_state(std::string argument, const std::string& state_folder) {
  constexpr std::string_view kPlace = "{state}";
  for (std::size_t at = argument.find(kPlace); at != std::string::npos;
       at = argument.find(kPlace, at + state_folder.size())) {
    argument.replace(at, kPlace.size(), state_folder);
  }
  return argument;
}

std::string program_path(const std::string& name, const std::string& executable) {
  if (name.find('/') != std::string::npos) return name;
  const auto beside = std::filesystem::path(executable).parent_path() / name;
  std::error_code ignored;
  return std::filesystem::exists(beside, ignored) ? beside.string() : name;
}

std::vector<char*> own_environment_without(const std::map<std::string, std::string>& names) {
  std::vector<char*> kept;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    if (!names.contains(std::string(text.substr(0, text.find('='))))) kept.push_back(*entry);
  }
  return kept;
}

}  // namespace

Result<Child> Child::start(std::vector<std::string> arguments, const std::string& executable,
                           const std::string& state_folder,
                           const std::map<std::string, std::string>& more_environment) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) {
    argument = with_state(std::move(argument), state_folder);
    argv.push_back(argument.data());
  }
  argv.push_back(nullptr);
  std::vector<std::string> settings;
  for (const auto& [name, value] : more_environment) settings.push_back(name + "=" + value);
  std::vector<char*> environment = own_environment_without(more_environment);
  for (std::string& setting : settings) environment.push_back(setting.data());
  environment.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);  // goniosim itself blocks what it reads by signalfd
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  const std::string program = program_path(arguments.front(), executable);
  pid_t pid = -1;
  const int trouble = posix_spawnp(&pid, program.c_str(), nullptr, &attributes, argv.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  if (trouble == 0) return Child(pid);
  return failure({.code = ErrorCode::FileUnreadable,
                  .device = "goniosim",
                  .tried = fmt::format("start {}", program),
                  .seen = std::strerror(trouble)});
}

void Child::signal(int number) const {
  ::kill(pid_, number);
}

std::optional<int> Child::ended() const {
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
  constexpr int kBySignal = 128;
  return WIFEXITED(status) ? WEXITSTATUS(status) : kBySignal + WTERMSIG(status);
}

}  // namespace gonio::sim
