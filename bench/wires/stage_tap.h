#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "base/clock.h"
#include "sim/wires/serial_pty.h"
#include "sim/wires/sockets.h"

namespace gonio::bench {

/// Between a daemon and its stage, on Modbus TCP or on a serial line: hands every byte on, notes when a halt and when a
/// motion passes whole, and can keep back what the engine asks, so that its link waits out its timeout.
/// Threads: one of its own; calls from any.
class StageTap {
 public:
  /// Listens on a free port of 127.0.0.1 and connects to `stage_port` there for each who comes.
  explicit StageTap(std::uint16_t stage_port);
  /// Makes a pseudo terminal that `line` leads to, and opens the stage's own.
  StageTap(const std::string& line, const std::string& stage_line);
  StageTap(const StageTap&) = delete;
  StageTap& operator=(const StageTap&) = delete;
  ~StageTap();

  [[nodiscard]] std::uint16_t port() const { return sim::port_of(listener_); }
  /// When the next halt came; call before it is asked for. Waits at most 10 s.
  void expect_halt();
  [[nodiscard]] std::optional<Instant> halt_came();
  /// Motion commands that came after the halt that was awaited.
  [[nodiscard]] long motions_since_halt() const;
  /// Requests that read are dropped from now on, or handed on again.
  void keep_back(bool on);
  /// Until a request has been dropped, at most 10 s; false when none was.
  [[nodiscard]] bool await_kept_back();

 private:
  struct Pair {
    sim::FileDescriptor daemon;
    sim::FileDescriptor stage;
    std::vector<std::uint8_t> received;  ///< of the daemon, not yet a whole request
    bool is_over = false;
  };
  void run(const std::stop_token& stop);
  void accept_one();
  void hand_back(Pair& pair) const;
  void take(Pair& pair);
  void hand_on(Pair& pair, std::span<const std::uint8_t> frame);
  [[nodiscard]] std::optional<std::size_t> request_length(std::span<const std::uint8_t> begin) const;
  void send(const sim::FileDescriptor& to, std::span<const std::uint8_t> bytes) const;

  std::uint16_t stage_port_ = 0;
  sim::FileDescriptor listener_;        ///< on TCP
  std::optional<sim::SerialPty> line_;  ///< on a serial line: there the one pair is always there
  sim::FileDescriptor wake_up_;
  std::vector<std::unique_ptr<Pair>> pairs_;
  SystemClock clock_;
  mutable std::mutex mutex_;  ///< guards all that follows
  std::condition_variable came_;
  std::optional<Instant> halt_;
  long motions_since_halt_ = 0;
  bool keeps_back_ = false;
  long kept_back_ = 0;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace gonio::bench
