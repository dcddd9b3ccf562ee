#include "daemon/analysis/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>

extern char** environ;

namespace gonio::daemon {
namespace {

constexpr std::size_t kLongestLine = 1U << 20U;
constexpr std::size_t kMostSaid = 2000;
constexpr int kBetweenLooksMs = 100;

struct Pipe {
  int read = -1;
  int write = -1;
};

Error cannot_start(const std::string& program, int reason) {
  return {.code = reason == ENOENT || reason == EACCES ? ErrorCode::FileUnreadable : ErrorCode::Internal,
          .device = "analysis",
          .tried = "start the worker program",
          .seen = std::strerror(reason),
          .where = InputLocation{program, 0, ""}};
}

Result<Pipe> make_pipe(const std::string& program) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return failure(cannot_start(program, errno));
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return Pipe{.read = ends[0], .write = ends[1]};
}

// 0, or errno.
int spawn(pid_t& pid, const std::vector<std::string>& arguments, const Pipe& output, const Pipe& complaints) {
  std::vector<char*> words;
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, output.write, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, complaints.write, STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  sigset_t usual;
  sigemptyset(&usual);
  sigaddset(&usual, SIGPIPE);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  const int reason = posix_spawn(&pid, words[0], &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return reason;
}

std::string end_text(int status) {
  if (WIFSIGNALED(status)) return fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

}  // namespace

Result<WorkerProcess> WorkerProcess::start(const std::vector<std::string>& arguments) {
  const Result<Pipe> output = make_pipe(arguments[0]);
  if (!output) return failure(output.error());
  const Result<Pipe> complaints = make_pipe(arguments[0]);
  if (!complaints) {
    close(output->read);
    close(output->write);
    return failure(complaints.error());
  }
  pid_t pid = -1;
  const int reason = spawn(pid, arguments, *output, *complaints);
  close(output->write);
  close(complaints->write);
  if (reason == 0) return WorkerProcess(pid, output->read, complaints->read);
  close(output->read);
  close(complaints->read);
  return failure(cannot_start(arguments[0], reason));
}

WorkerProcess::WorkerProcess(pid_t pid, int output, int complaints)
    : pid_(pid), output_(output), complaints_(complaints) {}

WorkerProcess::WorkerProcess(WorkerProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      output_(std::exchange(other.output_, -1)),
      complaints_(std::exchange(other.complaints_, -1)),
      pending_(std::move(other.pending_)),
      said_(std::move(other.said_)) {}

WorkerProcess::~WorkerProcess() {
  if (pid_ > 0) {
    kill();
    (void)wait();
  }
  if (output_ >= 0) close(output_);
  if (complaints_ >= 0) close(complaints_);
}

Result<std::optional<std::string>> WorkerProcess::next_line(const Clock& clock, Instant deadline,
                                                            const std::atomic<bool>& cancelled) {
  const auto error = [](ErrorCode code, std::string seen) {
    return failure({.code = code, .device = "analysis", .tried = "run the job", .seen = std::move(seen), .limit = {}});
  };
  for (;;) {
    if (const std::size_t end = pending_.find('\n'); end != std::string::npos) {
      std::string line = pending_.substr(0, end);
      pending_.erase(0, end + 1);
      return std::optional(std::move(line));
    }
    if (pending_.size() > kLongestLine) return error(ErrorCode::Internal, "a line without an end");
    if (cancelled) return error(ErrorCode::Stopped, "it was cancelled");
    if (clock.now() >= deadline) return error(ErrorCode::TimedOut, "it was not done at its deadline");
    std::array<pollfd, 2> looks{pollfd{output_, POLLIN, 0}, pollfd{complaints_, POLLIN, 0}};
    poll(looks.data(), looks.size(), kBetweenLooksMs);
    take_complaints();
    std::array<char, 4096> bytes{};
    const ssize_t n = read(output_, bytes.data(), bytes.size());
    if (n == 0) return std::optional<std::string>();
    if (n > 0) pending_.append(bytes.data(), static_cast<std::size_t>(n));
  }
}

void WorkerProcess::take_complaints() {
  std::array<char, 4096> bytes{};
  for (ssize_t n = 0; (n = read(complaints_, bytes.data(), bytes.size())) > 0;) {
    said_.append(bytes.data(), static_cast<std::size_t>(n));
    if (said_.size() > kMostSaid) said_.erase(0, said_.size() - kMostSaid);
  }
}

void WorkerProcess::kill() const {
  if (pid_ > 0) ::kill(-pid_, SIGKILL);
}

std::string WorkerProcess::wait() {
  if (pid_ <= 0) return "nothing";
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  take_complaints();
  std::string text = end_text(status);
  if (!said_.empty()) text += ", saying: " + said_;
  return text;
}

}  // namespace gonio::daemon
