#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/result.h"
#include "sim/wires/live_instrument.h"
#include "sim/wires/modbus_reply.h"
#include "sim/wires/reply_fault.h"
#include "sim/wires/sockets.h"
#include "sim/wires/stage_wire.h"

namespace gonio::sim {

/// The stage on Modbus TCP: many clients, one thread, whole requests only, so that one who stalls in mid-frame or never
/// reads holds up nobody, STOP least of all. Threads: any.
class ModbusServer final : public StageWire {
 public:
  /// Serves from here on. `instrument` must outlive it. Errors: PortBusy, InvalidInput, Internal.
  [[nodiscard]] static Result<std::unique_ptr<ModbusServer>> start(LiveInstrument& instrument,
                                                                   const std::string& address, std::uint16_t port);
  ~ModbusServer() override;
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_of(listener_); }
  void set_silent(bool on) override { is_silent_ = on; }
  /// Every connection is closed, and every new one at once.
  void set_refusing(bool on) override;
  [[nodiscard]] bool can_have(FaultKind kind) const override { return kind != FaultKind::ReplyBadCrc; }

 private:
  /// A reply that a fault keeps back.
  struct Late {
    Instant due;
    std::vector<std::uint8_t> bytes;
  };
  struct Client {
    FileDescriptor socket;
    std::vector<std::uint8_t> received;
    std::vector<std::uint8_t> to_send;
    std::deque<Late> late;                ///< in the order of their time
    std::vector<std::uint8_t> last_look;  ///< the last reply to a look
    bool is_gone = false;
  };
  ModbusServer(LiveInstrument& instrument, FileDescriptor listener, FileDescriptor wake_up, ModbusReply reply);
  void run(const std::stop_token& stop);
  void accept_clients();
  void receive(Client& client);
  void take_requests(Client& client);
  void answer(Client& client, std::span<const std::uint8_t> request);
  void send(Client& client);
  void release_late(Instant now);
  void drop_clients();
  [[nodiscard]] int patience_ms() const;
  [[nodiscard]] bool refuses();

  LiveInstrument& instrument_;
  FileDescriptor listener_;
  FileDescriptor wake_up_;
  ModbusReply reply_;
  std::list<Client> clients_;
  bool drops_clients_ = false;   ///< a fault closes every connection
  bool resets_clients_ = false;  ///< and says nothing more
  std::atomic<bool> is_silent_{false};
  std::atomic<bool> is_refusing_{false};
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace gonio::sim
