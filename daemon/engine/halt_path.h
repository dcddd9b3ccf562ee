#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/stage.h"

namespace gonio::daemon {

/// What came of a STOP. A halt that failed is tried until it is delivered: a success for the same epoch follows.
struct HaltReport {
  drivers::Epoch epoch = 0;
  std::string who;  ///< who asked first, when several asked before it was sent
  Result<void> outcome;
  Duration took{};  ///< from the call of `stop` to the stage's acknowledgement or the failure
};
/// The line of STOP and heartbeat went down or came back; once for each change.
struct HaltLineReport {
  bool is_up = false;
  std::optional<Error> error;  ///< why it is down
};
using HaltPathReport = std::variant<HaltReport, HaltLineReport>;

struct HaltPathConfig {
  Duration heartbeat_timeout{};  ///< zero: the stage does not watch us
  drivers::Epoch first_epoch = 0;
  Duration retry = std::chrono::milliseconds(100);  ///< between tries of a halt that was not delivered
};

/// The way of STOP: its own thread and its own line to the stage, so that it waits for nothing that the engine waits
/// for.
///
/// It also feeds the stage's heartbeat, a quarter of the timeout apart, and only while the engine renews its token: an
/// engine that is stuck stops the stage too. Each time the watch is armed anew: a stage that was powered up has
/// forgotten it. A beat in progress gives way to a halt at once.
class HaltPath {
 public:
  /// Called on the halt thread: hand it on, do not block.
  using Report = std::function<void(const HaltPathReport&)>;

  /// `line` and `clock` must outlive it.
  HaltPath(drivers::HaltLine& line, const Clock& clock, HaltPathConfig config, Report report);
  /// Leaves the watch armed: nothing moves for long without a daemon. A halt that was asked for is tried once more.
  ~HaltPath();
  HaltPath(const HaltPath&) = delete;
  HaltPath& operator=(const HaltPath&) = delete;

  /// Raises the epoch and wakes the halt thread; returns the new epoch at once, before the halt is on the wire.
  /// Threads: any.
  drivers::Epoch stop(const std::string& who);
  /// Threads: any.
  [[nodiscard]] drivers::Epoch epoch() const;
  /// Takes over a higher epoch: the stage's, after the daemon was started anew. Threads: any.
  void adopt(drivers::Epoch at_least);
  /// The engine is alive. To be called more often than every quarter of the heartbeat timeout. Threads: any.
  void renew();

 private:
  struct Pending {
    drivers::Epoch epoch = 0;
    std::string who;
    Instant asked{};
  };

  void run();
  void deliver(std::unique_lock<std::mutex>& lock);
  void feed(std::unique_lock<std::mutex>& lock);
  void report_line(std::unique_lock<std::mutex>& lock, const Result<void>& outcome);
  [[nodiscard]] Instant next_wake() const;

  drivers::HaltLine& line_;
  const Clock& clock_;
  const HaltPathConfig config_;
  Report report_;

  mutable std::mutex mutex_;  ///< guards all that follows
  std::condition_variable wake_;
  drivers::Epoch epoch_;
  std::optional<Pending> pending_;
  bool has_failed_ = false;  ///< the pending halt, at least once
  bool is_feeding_ = false;  ///< the halt thread is inside the line with a beat
  bool is_renewed_ = false;  ///< since the last beat
  bool is_closing_ = false;
  std::optional<bool> is_up_;
  Instant next_beat_{};
  Instant next_try_{};
  std::thread thread_;
};

}  // namespace gonio::daemon
