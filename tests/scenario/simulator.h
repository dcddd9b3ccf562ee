#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace gonio::test {

/// What the simulator itself says of its stage: the truth behind the wire.
struct SeenAxis {
  double position = 0.0;  ///< own unit: deg, mm or slot
  double target = 0.0;
  bool moving = false;
  bool homed = false;
};
struct SeenStage {
  std::map<std::string, SeenAxis> axes;
  bool moving = false;
  bool homed = false;
  bool halted = false;
  bool heartbeat_tripped = false;
  long fault = 0;
  long boot_counter = 0;
  long motion_commands = 0;  ///< accepted since power-up
  long shutter_commands = 0;
};

/// Exposures with the same place of the stage, to 0.01 deg.
struct ExposedPlace {
  std::string station;  ///< "sample", "reference", "trap", "between"
  double theta_i_deg = 0.0;
  double theta_r_deg = 0.0;
  double phi_r_deg = 0.0;
  long count = 0;
};
/// What was exposed so far, by the simulator's own count: each counts when it is triggered, and no restart sets it
/// back.
struct SeenExposures {
  long total = 0;
  long dark = 0;
  std::vector<ExposedPlace> lit;
};

/// One goniosim as a process of its own. It outlives daemons, and is killed at the end. Throws std::runtime_error, with
/// what the program said, when it does not come up or does not answer.
class Simulator {
 public:
  /// Everything it writes lies below `folder`. It has a camera address of its own. `history`: moves and exposures of
  /// earlier runs, after which the noise goes on.
  Simulator(const std::string& folder, const std::string& scene_file, std::uint64_t seed,
            const std::string& stage_wire = "tcp", long history = 0, const std::string& stage = "goniod");

  /// SIGKILL: stage and camera are gone as by a power cut.
  void kill() { process_.kill(); }
  /// Again, on the same folder and addresses: a stage that has forgotten its home. Waits until it is up.
  void restart();

  [[nodiscard]] const std::string& state_folder() const { return state_; }
  [[nodiscard]] std::string instrument_file() const { return state_ + "/instrument.toml"; }
  [[nodiscard]] std::string reference_folder() const { return state_ + "/reference"; }

  /// What a daemon needs in its environment to see the simulator's USB, each as NAME=VALUE; empty without one.
  [[nodiscard]] std::vector<std::string> usb_environment() const;

  [[nodiscard]] SeenStage stage() const;
  [[nodiscard]] SeenExposures exposures() const;

  /// The camera answers nothing and sends nothing; later it is back as after a power cycle.
  void silence_camera(bool on) const;
  /// The stage's connections stand, and nothing is answered.
  void silence_stage(bool on) const;
  /// The stage's connections are closed, new ones too.
  void refuse_stage(bool on) const;
  /// An axis stands still, whatever its drive does.
  void block_axis(const std::string& axis, bool on) const;
  /// As if the door of the dark room were open.
  void open_interlock(bool on) const;

  /// Arms a fault by name, with more keys of the control socket ("\"after\":2"); the answer.
  std::string fault(const std::string& name, const std::string& keys) const;
  /// A fault of that name is over.
  void end_fault(const std::string& name) const;
  /// One line of the control socket.
  [[nodiscard]] std::string ask(const std::string& line) const;

 private:
  void order(const std::string& line) const;
  void wait_until_ready();

  std::string state_;
  std::string log_;
  std::vector<std::string> command_;
  Process process_;
};

}  // namespace gonio::test
