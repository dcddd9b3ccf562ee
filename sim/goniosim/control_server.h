#pragma once

#include <list>
#include <memory>
#include <string>
#include <thread>

#include "base/result.h"
#include "sim/wires/live_instrument.h"
#include "sim/wires/sockets.h"
#include "sim/wires/stage_wire.h"
#include "sim/wires/usb_ports.h"

namespace gonio::sim {

/// The control socket: one JSON object a line in, one a line out, for tests and people that play fate.
///   {"query":"stage"}      axes, flags and counters of the stage
///   {"query":"exposures"}  exposures in all, lit ones, and by place
///   {"query":"faults"}     of each fault that was armed: still armed, fired, active
///   {"fault":NAME, ...}    arms a fault of sim/faults/fault_table.h, with the keys of a scene's [[faults]]; says what
///   it took
///   {"fault":NAME, "on":false}  whatever of this name is armed or stands is over
/// A refused line is answered {"ok":false,"error":"..."}. One thread; threads of callers: any.
class ControlServer {
 public:
  /// All must outlive it; `usb` may be null. Errors: PortBusy, InvalidInput, Internal.
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> start(const std::string& path, LiveInstrument& instrument,
                                                                    const StageWire& stage, UsbPorts* usb = nullptr);
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

 private:
  struct Client {
    FileDescriptor socket;
    std::string received;
    bool is_gone = false;
  };
  ControlServer(std::string path, FileDescriptor listener, FileDescriptor wake_up, LiveInstrument& instrument,
                const StageWire& stage, UsbPorts* usb);
  void run(const std::stop_token& stop);
  void receive(Client& client);

  std::string path_;
  FileDescriptor listener_;
  FileDescriptor wake_up_;
  LiveInstrument& instrument_;
  const StageWire& stage_;
  UsbPorts* usb_;
  std::list<Client> clients_;
  std::jthread thread_;  // last: it uses all of the above
};

/// The answer to one line. Threads: any.
[[nodiscard]] std::string answer_control(const std::string& line, LiveInstrument& instrument, const StageWire& stage);

}  // namespace gonio::sim
