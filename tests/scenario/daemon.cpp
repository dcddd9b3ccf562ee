#include "tests/scenario/daemon.h"

#include <csignal>
#include <filesystem>
#include <stdexcept>

#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

// The ready file of the daemon before this one would lie.
std::string without_old(const std::string& file) {
  std::filesystem::remove(file);
  return file;
}

// "http://127.0.0.1:40123"
int port_of(const std::string& url) {
  const std::size_t colon = url.rfind(':');
  if (colon == std::string::npos) throw std::runtime_error("not an address: \"" + url + "\"");
  return std::stoi(url.substr(colon + 1));
}

}  // namespace

std::vector<std::string> goniod_arguments(const DaemonFiles& files, const std::string& listen,
                                          const std::string& ready_file) {
  std::vector<std::string> line{kGoniod,          "--instrument", files.instrument, "--references",
                                files.references, "--store",      files.store,      "--listen",
                                listen,           "--ready-file", ready_file};
  if (!files.tape.empty()) line.insert(line.end(), {"--record", files.tape});
  return line;
}

namespace {

std::vector<std::string> with_environment(const std::vector<std::string>& settings, std::vector<std::string> command) {
  if (settings.empty()) return command;
  command.insert(command.begin(), settings.begin(), settings.end());
  command.insert(command.begin(), "/usr/bin/env");
  return command;
}

}  // namespace

Daemon::Daemon(const DaemonFiles& files, const std::string& folder, const std::vector<std::string>& environment)
    : ready_file_(without_old(folder + "/goniod.ready")),
      log_(folder + "/goniod.log"),
      process_(with_environment(environment, goniod_arguments(files, "127.0.0.1:0", ready_file_)), log_) {}

bool Daemon::has_ready_file() const {
  return std::filesystem::exists(ready_file_);
}

void Daemon::wait_until_ready() {
  const bool came_or_went = eventually([&] { return has_ready_file() || !process_.is_running(); }, kStartDeadline);
  if (!came_or_went || !process_.is_running()) throw std::runtime_error("goniod did not come up. " + tail_of(log_));
  port_ = port_of(text_of(ready_file_));
}

int Daemon::end() {
  process_.signal(SIGTERM);
  return process_.wait(kStepDeadline).value_or(-1);
}

HttpAnswer Daemon::get(const std::string& path) const {
  return http_request(port_, "GET", "/api/v1/" + path, {}, {}, kStepDeadline);
}

HttpAnswer Daemon::post(const std::string& path, const std::string& body) const {
  return http_request(port_, "POST", "/api/v1/" + path, body, {{"Content-Type", "application/json"}}, kStepDeadline);
}

}  // namespace gonio::test
