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

/// A stage for STOP alone: it notes when a halt has come whole, answers halts, and leaves everything else
/// unanswered. Behind a listening socket (Modbus TCP) or a pseudo terminal (Modbus RTU).
class StopWitness {
 public:
  /// `line` empty: TCP on a free port of 127.0.0.1.
  explicit StopWitness(const std::string& line);
  StopWitness(const StopWitness&) = delete;
  StopWitness& operator=(const StopWitness&) = delete;
  ~StopWitness();

  [[nodiscard]] std::uint16_t port() const;
  /// When the next halt came; call before it is sent. Waits at most 10 s.
  void expect_halt();
  [[nodiscard]] std::optional<Instant> halt_came();
  /// Until a request that is no halt comes, at most 10 s; false when none does.
  [[nodiscard]] bool await_other();

 private:
  struct Peer {
    sim::FileDescriptor socket;
    std::vector<std::uint8_t> received;
  };
  void run(const std::stop_token& stop);
  void take(Peer& peer, int descriptor);
  void hear(Peer& peer, int descriptor, std::size_t head);
  void note_halt();
  void note_other();

  bool is_serial_;
  std::optional<sim::SerialPty> pty_;
  sim::FileDescriptor listener_;
  sim::FileDescriptor wake_up_;
  std::vector<std::unique_ptr<Peer>> peers_;
  SystemClock clock_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::optional<Instant> halt_;
  std::uint64_t others_ = 0;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace gonio::bench
