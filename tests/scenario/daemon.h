#pragma once

#include <string>
#include <vector>

#include "tests/support/http_client.h"
#include "tests/support/process.h"

namespace gonio::test {

struct DaemonFiles {
  std::string instrument;
  std::string references;
  std::string store;
  std::string tape{};  ///< to be recorded; empty: none
};

/// The arguments that goniod is started with. `listen` is an address with port, 0 for any that is free.
[[nodiscard]] std::vector<std::string> goniod_arguments(const DaemonFiles& files, const std::string& listen,
                                                        const std::string& ready_file);

/// One goniod as a process, on a port of its own. Killed at the end unless it has ended.
class Daemon {
 public:
  /// Starts it and does not wait. Its log in `folder` gathers what several daemons say, one after the other.
  /// `environment`: settings as NAME=VALUE beside this process' own.
  Daemon(const DaemonFiles& files, const std::string& folder, const std::vector<std::string>& environment = {});

  /// Waits until REST answers. Throws std::runtime_error, with what the program said.
  void wait_until_ready();
  /// As the ready file says; 0 before.
  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

  /// SIGKILL.
  void kill() { process_.kill(); }
  /// SIGTERM; its exit code, -1 when it did not end.
  [[nodiscard]] int end();
  [[nodiscard]] bool has_ready_file() const;

  [[nodiscard]] HttpAnswer get(const std::string& path) const;
  [[nodiscard]] HttpAnswer post(const std::string& path, const std::string& body = "{}") const;

 private:
  int port_ = 0;
  std::string ready_file_;
  std::string log_;
  Process process_;
};

}  // namespace gonio::test
