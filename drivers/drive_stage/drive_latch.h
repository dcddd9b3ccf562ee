#pragma once

#include <cstdint>
#include <mutex>

#include "drivers/stage.h"

namespace gonio::drivers {

/// The STOP latch of a stage whose drives have none: what the halt line raises and the motion line asks. It lives in
/// this process and dies with it; what a drive keeps of a halt (`stopped` in its map) is all that a later one sees.
/// Threads: any.
class DriveLatch {
 public:
  struct Seen {
    Epoch epoch = 0;  ///< the lowest that is still obeyed
    bool halted = false;
    std::uint16_t stop_count = 0;
  };
  [[nodiscard]] Seen seen() const;
  [[nodiscard]] bool may_move(Epoch epoch) const;

  /// From here on nothing older may move, whatever becomes of the halt on the wire.
  void halt(Epoch epoch);
  /// False: the epoch is older than that of the last halt.
  [[nodiscard]] bool reset(Epoch epoch);

  /// Around the words that make axes move. A halt that meets them half said is said once more.
  void begin_motion() { set_in_motion(true); }
  void end_motion() { set_in_motion(false); }
  [[nodiscard]] bool is_in_motion() const;

 private:
  void set_in_motion(bool on);

  mutable std::mutex mutex_;
  Seen seen_;
  bool is_in_motion_ = false;
};

}  // namespace gonio::drivers
