#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "sim/wires/live_instrument.h"
#include "sim/wires/modbus_reply.h"
#include "sim/wires/reply_fault.h"
#include "sim/wires/serial_pty.h"
#include "sim/wires/stage_wire.h"

namespace gonio::sim {

/// A serial line has a speed, and a slave needs time to think: wall time, kept on a pseudo terminal that has neither.
struct RtuTiming {
  int baud = 115200;
  Duration turnaround = std::chrono::milliseconds(2);
};

/// The stage on Modbus RTU, behind a link to a pseudo terminal. One thread; threads of callers: any.
///
/// A request is obeyed when its last byte has come; the reply goes out whole, (request + reply bytes) * 11 / baud + the
/// turnaround later. A request for another unit, with a wrong CRC, or that stops in mid-frame is passed over in silence
/// (Modbus over Serial Line V1.02, 2.4 and 2.5.1).
class RtuServer final : public StageWire {
 public:
  /// Serves from here on. `instrument` must outlive it. Errors: InvalidInput (the link), Internal.
  [[nodiscard]] static Result<std::unique_ptr<RtuServer>> start(LiveInstrument& instrument, const std::string& link,
                                                                RtuTiming timing);
  ~RtuServer() override;
  RtuServer(const RtuServer&) = delete;
  RtuServer& operator=(const RtuServer&) = delete;

  void set_silent(bool on) override { is_silent_ = on; }
  /// The adapter is pulled out, and put back as a new terminal behind the same link.
  void set_refusing(bool on) override;
  [[nodiscard]] bool can_have(FaultKind kind) const override { return kind != FaultKind::ReplyWrongTransaction; }
  /// Requests for this unit that came whole, since the start.
  [[nodiscard]] std::uint64_t requests() const { return requests_; }

 private:
  struct Outgoing {
    Instant due;
    std::vector<std::uint8_t> bytes;
  };
  RtuServer(LiveInstrument& instrument, std::string link, RtuTiming timing, FileDescriptor wake_up, ModbusReply reply,
            SerialPty pty);
  void run(const std::stop_token& stop);
  [[nodiscard]] int patience_ms(Instant now) const;
  void plug();
  void receive();
  void take_requests();
  void take_what_stopped(Instant now);
  void answer(std::span<const std::uint8_t> frame);
  void put_out(Duration after, std::vector<std::uint8_t> bytes);
  [[nodiscard]] bool refuses();
  void send_due(Instant now);
  [[nodiscard]] Duration time_of(std::size_t bytes) const;

  LiveInstrument& instrument_;
  const std::string link_;
  const RtuTiming timing_;
  const SystemClock clock_;
  FileDescriptor wake_up_;
  ModbusReply reply_;
  std::optional<SerialPty> pty_;  ///< none while it refuses
  std::vector<std::uint8_t> received_;
  Instant last_byte_{};
  std::deque<Outgoing> to_send_;
  std::vector<std::uint8_t> last_look_;  ///< the last reply to a look
  bool is_pulled_ = false;               ///< a fault has the adapter out
  bool reopens_ = false;                 ///< and back at once
  std::atomic<std::uint64_t> requests_{0};
  std::atomic<bool> is_silent_{false};
  std::atomic<bool> is_refusing_{false};
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace gonio::sim
