#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "base/clock.h"
#include "sim/wires/sockets.h"

namespace gonio::bench {

/// Between a daemon and its stage on Modbus TCP: hands every byte on, notes when a halt and when a motion passes whole,
/// and can keep back what the engine's own connection asks, so that it waits out its timeout.
/// Threads: one of its own; calls from any.
class StageTap {
 public:
  /// Listens on a free port of 127.0.0.1 and connects to `stage_port` there for each who comes.
  explicit StageTap(std::uint16_t stage_port);
  StageTap(const StageTap&) = delete;
  StageTap& operator=(const StageTap&) = delete;
  ~StageTap();

  [[nodiscard]] std::uint16_t port() const { return sim::port_of(listener_); }
  /// When the next halt came; call before it is asked for. Waits at most 10 s.
  void expect_halt();
  [[nodiscard]] std::optional<Instant> halt_came();
  /// Motion commands that came after the halt that was awaited.
  [[nodiscard]] long motions_since_halt() const;
  /// Requests of a connection that reads are dropped from now on, or handed on again.
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
  static void hand_back(Pair& pair);
  void take(Pair& pair);
  void hand_on(Pair& pair, std::span<const std::uint8_t> frame);

  std::uint16_t stage_port_;
  sim::FileDescriptor listener_;
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
