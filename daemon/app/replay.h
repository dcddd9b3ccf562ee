#pragma once

#include <iosfwd>
#include <string>

#include "base/result.h"

namespace gonio::daemon {

struct ReplayWanted {
  std::string tape_file;
  std::string store_file;       ///< written; must hold what the recording's store held at its start: nothing, as a rule
  std::string instrument_file;  ///< empty: the tape's own
  std::string against;          ///< a store to compare with at the end; empty: none
};

/// Runs the engine and its drivers on a tape in place of the devices, in one thread and without waiting, and says on
/// `out` what was done and how fast. The same tape and program give the same store, always.
///
/// Errors: ReplayDiffers (the first request, message or stored value that is another), WrongState (the store is not the
/// one that the recording began on), and those of the tape, the instrument and the store.
[[nodiscard]] Result<void> replay(const ReplayWanted& wanted, std::ostream& out);

}  // namespace gonio::daemon
