#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "sim/devices/instrument.h"
#include "sim/wires/file_descriptor.h"

namespace gonio::sim {

/// The exposures since the state was saved, in a ring on the disk: what a SIGKILL of the simulator would take from its
/// counts. One write of the page cache an exposure, a few microseconds; no sync, since the simulator's own power cut is
/// nobody's business. Threads: one at a time.
class ExposureJournal {
 public:
  /// Exposures that may lie between two saves of the state.
  static constexpr std::uint64_t kSlots = 8192;

  /// Makes the file if need be. Errors: DiskFull.
  [[nodiscard]] static Result<ExposureJournal> open(const std::string& file);

  /// Before the exposure begins. A disk that takes no more costs the counts of a kill, not the exposure.
  void note(const ExposureNote& exposure) const;
  /// Adds what was noted after the state of `memory` was saved.
  void catch_up(InstrumentMemory& memory) const;

 private:
  explicit ExposureJournal(FileDescriptor file) : file_(std::move(file)) {}
  FileDescriptor file_;
};

}  // namespace gonio::sim
