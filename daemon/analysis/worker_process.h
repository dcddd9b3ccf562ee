#pragma once

#include <sys/types.h>

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/result.h"

namespace gonio::daemon {

/// A child program whose output is read line by line. It gets nothing of ours: no open file but its standard ones, no
/// blocked signal, a process group of its own. The destructor kills the group and reaps the program. Threads: one.
class WorkerProcess {
 public:
  /// `arguments` begin with the program's path. Errors: FileUnreadable (there is no such program), Internal.
  [[nodiscard]] static Result<WorkerProcess> start(const std::vector<std::string>& arguments);
  WorkerProcess(WorkerProcess&& other) noexcept;
  WorkerProcess& operator=(WorkerProcess&&) = delete;
  ~WorkerProcess();

  /// The next line of its standard output; nothing once it has closed it. Errors: TimedOut at `deadline`, Stopped when
  /// `cancelled` was set, Internal for a line beyond 1 MiB.
  [[nodiscard]] Result<std::optional<std::string>> next_line(const Clock& clock, Instant deadline,
                                                             const std::atomic<bool>& cancelled);
  /// SIGKILL to its whole group.
  void kill() const;
  /// Waits for its end, which must be near; "exit code 2" or "signal 9 (Killed)", and what it said last on standard
  /// error.
  [[nodiscard]] std::string wait();

 private:
  WorkerProcess(pid_t pid, int output, int complaints);
  void take_complaints();

  pid_t pid_;
  int output_;
  int complaints_;
  std::string pending_;
  std::string said_;  ///< the end of its standard error
};

}  // namespace gonio::daemon
