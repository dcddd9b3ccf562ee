#pragma once

#include <netinet/in.h>
#include <time.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/result.h"
#include "sim/wires/camera_registers.h"
#include "sim/wires/gvcp.h"
#include "sim/wires/gvsp_stream.h"
#include "sim/wires/live_instrument.h"
#include "sim/wires/sockets.h"

namespace gonio::sim {

/// The camera on GigE Vision: control (GVCP), description (GenICam), stream (GVSP), on an address of its own in
/// 127.0.0.0/8. It exposes on software triggers only. One controller at a time; one that falls silent is released after
/// the heartbeat timeout (register 0x938, 3 s at first). One thread; threads of callers: any.
class GigeCameraServer {
 public:
  /// Serves from here on. `instrument` must outlive it. Errors: PortBusy, InvalidInput, Internal.
  [[nodiscard]] static Result<std::unique_ptr<GigeCameraServer>> start(LiveInstrument& instrument,
                                                                       const std::string& address);
  ~GigeCameraServer();
  GigeCameraServer(const GigeCameraServer&) = delete;
  GigeCameraServer& operator=(const GigeCameraServer&) = delete;

  /// On: as if its cable were out. Off again: as after a power cycle, without controller and with its first settings.
  void set_silent(bool on);

 private:
  GigeCameraServer(LiveInstrument& instrument, CameraIdentity identity, FileDescriptor control,
                   FileDescriptor broadcasts, FileDescriptor stream, FileDescriptor wake_up);
  void run(const std::stop_token& stop);
  [[nodiscard]] timespec poll_timeout(std::optional<Instant> due) const;
  void power_up();
  void power_up_if_wanted();
  std::optional<Instant> work(Instant now);
  void collect_frame();
  [[nodiscard]] SentRegion region() const;
  void release_silent_controller(Instant now);

  void receive();
  void answer_search();
  [[nodiscard]] GvcpStatus serve(const GvcpRequest& request, std::vector<std::uint8_t>& answer);
  [[nodiscard]] GvcpStatus read_registers(const GvcpRequest& request, std::vector<std::uint8_t>& answer) const;
  [[nodiscard]] GvcpStatus read_memory(const GvcpRequest& request, std::vector<std::uint8_t>& answer) const;
  [[nodiscard]] GvcpStatus write_registers(const GvcpRequest& request, std::vector<std::uint8_t>& answer);
  [[nodiscard]] GvcpStatus write_memory(const GvcpRequest& request, std::vector<std::uint8_t>& answer);
  [[nodiscard]] GvcpStatus write_word(std::uint32_t at, std::uint32_t value);
  [[nodiscard]] GvcpStatus apply(std::uint32_t at);
  [[nodiscard]] GvcpStatus apply_settings();
  [[nodiscard]] GvcpStatus trigger();
  [[nodiscard]] bool is_controller() const;
  void release_control();

  // ---- faults ----
  [[nodiscard]] bool is_active(FaultKind kind);
  void follow_faults();
  void put_on_stream(CameraFrame frame);
  void spoil(const PlannedFault& fault, CameraFrame frame);

  LiveInstrument& instrument_;
  CameraIdentity identity_;
  FileDescriptor control_;
  FileDescriptor broadcasts_;
  FileDescriptor stream_socket_;
  FileDescriptor wake_up_;
  CameraRegisters registers_;
  GvspStream stream_;
  std::optional<sockaddr_in> controller_;
  Instant controller_seen_{};
  sockaddr_in sender_{};  ///< of the request being served
  /// A frame that a fault keeps back.
  struct LateFrame {
    Instant due;
    CameraFrame frame;
  };
  std::optional<LateFrame> late_;
  std::optional<CameraFrame> last_frame_;  ///< as it was sent
  bool is_unplugged_ = false;              ///< by a fault
  bool is_taken_ = false;                  ///< by another controller
  std::atomic<bool> is_silent_{false};
  std::atomic<unsigned> power_ups_wanted_{0};
  unsigned power_ups_ = 0;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace gonio::sim
