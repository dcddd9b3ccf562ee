#pragma once

#include <list>
#include <memory>
#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "sim/goniosim/control_server.h"
#include "sim/goniosim/exposure_journal.h"
#include "sim/goniosim/state_folder.h"
#include "sim/wires/gige_camera_server.h"
#include "sim/wires/live_instrument.h"
#include "sim/wires/stage_wire.h"
#include "sim/wires/usb_ports.h"

namespace gonio::sim {

/// Which addresses are asked for; what is left open is the last run's, or free.
struct WireWishes {
  bool wants_rtu = false;  ///< the stage on a serial line instead of TCP
  int stage_baud = 115200;
  std::uint16_t stage_port = 0;
  std::string camera_address;
  MakeUsbPorts make_usb;  ///< for a scene with radiometers
};

/// A whole simulated instrument on its wires, living in a state folder: what goniosim is around its command line.
/// Threads: owned by one; the wires have their own.
class Simulator {
 public:
  /// Powers up: boot counter + 1, wires, papers, control socket, ready file. `clock` must outlive it.
  /// Errors: Busy (the folder), PortBusy, InvalidInput, FileUnreadable, DiskFull, Internal (no USB).
  [[nodiscard]] static Result<std::unique_ptr<Simulator>> start(Scene scene, const std::string& state_folder,
                                                                const WireWishes& wishes, const Clock& clock);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  [[nodiscard]] const WireAddresses& addresses() const { return addresses_; }
  [[nodiscard]] const StateFolder& folder() const { return folder_; }
  [[nodiscard]] LiveInstrument& instrument() { return instrument_; }
  /// Writes the state if anything has happened since the last time. Errors: DiskFull.
  [[nodiscard]] Result<void> save();

 private:
  Simulator(Scene scene, StateFolder folder, InstrumentMemory memory, ExposureJournal journal, const Clock& clock);
  [[nodiscard]] Result<void> bind(const SimulatorState& last, const WireWishes& wishes);
  [[nodiscard]] Result<void> bind_stage(const SimulatorState& last, const WireWishes& wishes);
  [[nodiscard]] Result<void> plug_radiometers(const WireWishes& wishes);
  [[nodiscard]] Result<void> bind_camera(const std::string& wished);

  StateFolder folder_;
  ExposureJournal journal_;
  LiveInstrument instrument_;
  WireAddresses addresses_;
  std::uint64_t saved_exposures_ = 0;
  std::uint64_t saved_moves_ = 0;
  bool has_saved_ = false;
  std::unique_ptr<StageWire> stage_;
  std::unique_ptr<GigeCameraServer> camera_;
  std::list<LiveRadiometer> radiometers_;  ///< in the order of the scene, which is that of the ports
  std::unique_ptr<UsbPorts> usb_;          ///< null: the scene has no radiometer
  std::unique_ptr<ControlServer> control_;
};

}  // namespace gonio::sim
