#pragma once

#include "sim/faults/fault_table.h"

namespace gonio::sim {

/// What fate can do to the stage's wire, whichever it is. Threads: any.
class StageWire {
 public:
  virtual ~StageWire() = default;
  /// Requests are read, and neither acted upon nor answered.
  virtual void set_silent(bool on) = 0;
  /// Nobody gets through: connections are closed, new ones too; a serial adapter is pulled out.
  virtual void set_refusing(bool on) = 0;
  /// Whether this fault makes sense on this wire.
  [[nodiscard]] virtual bool can_have(FaultKind kind) const = 0;
};

}  // namespace gonio::sim
