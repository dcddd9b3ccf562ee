#pragma once

#include "drivers/links/tape/tape_record.h"

namespace gonio::drivers {

/// Where records go. Threads: any; the order of the calls is the order on the tape.
class TapeSink {
 public:
  virtual ~TapeSink() = default;
  /// Never blocks for a disk, and cannot fail: what cannot be kept ends the recording, not the scan.
  virtual void put(TapeRecord record) = 0;
};

}  // namespace gonio::drivers
