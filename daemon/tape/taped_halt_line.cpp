#include "daemon/tape/taped_halt_line.h"

namespace gonio::daemon {

void take_turn(drivers::HaltLine& line, const drivers::TapeTurn& turn) {
  switch (static_cast<HaltTurn>(turn.source)) {
    case HaltTurn::Halt:
      (void)line.halt(static_cast<drivers::Epoch>(turn.argument));
      return;
    case HaltTurn::Watch:
      (void)line.watch_heartbeat(Duration(turn.argument));
      return;
    case HaltTurn::Beat:
      (void)line.beat();
      return;
  }
}

}  // namespace gonio::daemon
