#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace gonio::test {

/// A child program with its output in a file. The destructor kills it (SIGKILL) and reaps it.
class Process {
 public:
  /// What it says goes to `output_file`, its complaints too unless they have a file of their own.
  /// Throws std::runtime_error when it cannot be started.
  Process(const std::vector<std::string>& arguments, const std::string& output_file,
          const std::string& errors_file = {});
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&& other) noexcept;

  /// Sends a signal; nothing happens when the program has ended.
  void signal(int number) const;
  /// SIGKILL, then reaps.
  void kill();
  /// Waits for its end; the exit code (128 + signal when killed by one), or nothing at the deadline.
  std::optional<int> wait(std::chrono::seconds deadline);
  [[nodiscard]] bool is_running();
  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = -1;
};

/// What a program that has ended left behind.
struct Finished {
  int exit_code = -1;  ///< -1: it had not ended at the deadline and was killed
  std::string output;
  std::string errors;
};

/// Runs a program to its end, below `folder`, which keeps its output.
[[nodiscard]] Finished run_program(const std::vector<std::string>& arguments, const std::string& folder,
                                   std::chrono::seconds deadline);

/// Polls `condition` every few ms until it holds; false at the deadline, which bounds hanging and is never a speed to
/// be met.
template <class Condition>
bool eventually(Condition condition, std::chrono::milliseconds deadline);

[[nodiscard]] std::string text_of(const std::string& file);
void write_text(const std::string& file, const std::string& text);
/// The last lines of a file: what a program said, for the message of a failed test.
[[nodiscard]] std::string tail_of(const std::string& file, std::size_t lines = 40);
/// A TCP port of 127.0.0.1 that was free a moment ago.
[[nodiscard]] int free_port();

namespace detail {
void pause_briefly();
}

template <class Condition>
bool eventually(Condition condition, std::chrono::milliseconds deadline) {
  const auto end = std::chrono::steady_clock::now() + deadline;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    detail::pause_briefly();
  }
  return true;
}

}  // namespace gonio::test
