#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "sim/devices/instrument.h"
#include "sim/scene/papers.h"
#include "sim/wires/file_descriptor.h"

namespace gonio::sim {

/// What a simulator keeps between its runs.
struct SimulatorState {
  InstrumentMemory instrument;
  std::uint16_t stage_port = 0;  ///< 0: none yet
  std::string camera_address;    ///< empty: none yet
};

/// The folder of --state: where the simulator keeps itself and lays out what the daemon needs. One simulator at a time.
/// Every file is written aside and renamed. Threads: owned by one.
class StateFolder {
 public:
  /// Makes the folder if need be. Errors: FileUnreadable (cannot be made), Busy (another simulator lives in it).
  [[nodiscard]] static Result<StateFolder> open(const std::string& path);

  /// The state of the last run up to its last exposure, or an empty one. Errors: InvalidInput (not what `save` writes),
  /// DiskFull.
  [[nodiscard]] Result<SimulatorState> load() const;
  /// Errors: DiskFull.
  [[nodiscard]] Result<void> save(const SimulatorState& state) const;
  /// instrument.toml and reference/SERIAL.toml. Errors: DiskFull.
  [[nodiscard]] Result<void> write_papers(const Scene& scene, const WireAddresses& addresses) const;
  /// `ready`, one JSON object: the wires work from now on. Errors: DiskFull.
  [[nodiscard]] Result<void> write_ready(const WireAddresses& addresses) const;
  void remove_ready() const;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string exposure_journal() const { return path_ + "/exposures.journal"; }
  [[nodiscard]] std::string stage_line() const { return path_ + "/stage.tty"; }
  [[nodiscard]] std::string control_socket() const { return path_ + "/control.sock"; }
  [[nodiscard]] std::string instrument_file() const { return path_ + "/instrument.toml"; }

 private:
  StateFolder(std::string path, FileDescriptor lock) : path_(std::move(path)), lock_(std::move(lock)) {}
  [[nodiscard]] Result<void> write(const std::string& name, const std::string& text) const;
  std::string path_;
  FileDescriptor lock_;
};

}  // namespace gonio::sim
