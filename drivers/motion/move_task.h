#pragma once

#include <cstdint>
#include <optional>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/motion/motion_progress.h"
#include "drivers/motion/motion_watch.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// Waits for one move: a pure state machine that is shown `StageState`s and says when to look next.
///
/// Done is not there: the move counts when our command was accepted, no fault came up, nobody stopped the stage, and
/// for every named axis the looks of a whole settle time found the encoder in its window and the axis at rest. The
/// first look comes when the move should be over (or after `kLongestUnseen`, to see a fault in a long one), then looks
/// follow at a quarter of its lateness, at most a quarter of the shortest settle time apart.
class MoveTask {
 public:
  static constexpr Duration kLongestUnseen = std::chrono::milliseconds(250);

  /// Whether the axes must settle at the end, or only come to rest there, to go on.
  enum class Ending : std::uint8_t { Settle, Rest };

  /// `before` is a look from just before the command was sent at `now`. Axes without a target are not waited for.
  MoveTask(const StageConfig& config, const StageState& before, const MotionTarget& target, MotionToken token,
           Epoch epoch, Instant now, Ending ending = Ending::Settle);

  /// Errors: those of MotionWatch; NotHomed; MotionLate with the axis, where it is and where it should be.
  [[nodiscard]] Result<MotionProgress> look(const StageState& seen, Instant now);

  [[nodiscard]] Instant first_look() const { return started_; }
  /// Counted from the first look that saw the command accepted, so that it is not early.
  [[nodiscard]] Instant predicted_arrival() const { return accepted_at_.value_or(started_) + travel_; }
  [[nodiscard]] Instant deadline() const { return deadline_; }

 private:
  [[nodiscard]] bool is_in_place(stage::Axis axis, const StageState& seen) const;
  [[nodiscard]] std::optional<Instant> settled_at(const StageState& seen, Instant now);
  [[nodiscard]] bool is_overdue(std::optional<Instant> settled, Instant now);
  [[nodiscard]] Result<void> check_homed(const StageState& seen) const;
  [[nodiscard]] Error late(const StageState& seen, bool accepted) const;

  stage::PerAxis<AxisConfig> axes_;
  MotionTarget target_;
  MotionWatch watch_;
  Instant started_;
  Duration travel_{};
  std::optional<Instant> accepted_at_;  ///< the first look that saw it
  Instant deadline_{};
  Duration poll_{};
  Duration settle_{};                ///< of the slowest named axis
  std::optional<Instant> overtime_;  ///< the first look at or after the deadline
  stage::PerAxis<std::optional<Instant>> in_place_since_{};
};

/// "move theta_r to 45.000 deg, carriage to 120.000 mm": a motion in the words of an error.
[[nodiscard]] std::string motion_text(const MotionTarget& target);

}  // namespace gonio::drivers
