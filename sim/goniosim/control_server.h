#pragma once

#include <list>
#include <memory>
#include <string>
#include <thread>

#include "base/result.h"
#include "sim/wires/gige_camera_server.h"
#include "sim/wires/live_instrument.h"
#include "sim/wires/sockets.h"
#include "sim/wires/stage_wire.h"

namespace gonio::sim {

/// The control socket: one JSON object a line in, one a line out, for tests and people that play fate.
///   {"query":"stage"}      axes, flags and counters of the stage
///   {"query":"exposures"}  exposures in all, lit ones, and by place
///   {"fault":"stage-silent" | "stage-refuse" | "camera-silent" | "interlock-open", "on":true|false}
///   {"fault":"axis-blocked", "axis":"theta_r", "on":true|false}
///   {"fault":"stage-power-cycle"}
/// A refused line is answered {"ok":false,"error":"..."}. One thread; threads of callers: any.
class ControlServer {
 public:
  /// All three must outlive it. Errors: PortBusy, InvalidInput, Internal.
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> start(const std::string& path, LiveInstrument& instrument,
                                                                    StageWire& stage, GigeCameraServer& camera);
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
                StageWire& stage, GigeCameraServer& camera);
  void run(const std::stop_token& stop);
  void receive(Client& client);

  std::string path_;
  FileDescriptor listener_;
  FileDescriptor wake_up_;
  LiveInstrument& instrument_;
  StageWire& stage_;
  GigeCameraServer& camera_;
  std::list<Client> clients_;
  std::jthread thread_;  // last: it uses all of the above
};

/// The answer to one line. Threads: any.
[[nodiscard]] std::string answer_control(const std::string& line, LiveInstrument& instrument, StageWire& stage,
                                         GigeCameraServer& camera);

}  // namespace gonio::sim
