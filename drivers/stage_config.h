#pragma once

#include <cstdint>
#include <optional>

#include "base/clock.h"
#include "drivers/keep_out/keep_out.h"
#include "drivers/kinematics/kinematics_config.h"
#include "protocol/stage/axis.h"
#include "protocol/stage/drive_stage_map.h"
#include "protocol/stage/register_map.h"

namespace gonio::drivers {

/// The side from which an axis with backlash arrives. Names in files: "any", "from below", "from above".
enum class Approach : std::uint8_t { Any, FromBelow, FromAbove };

/// One axis as instrument.toml has it; positions in the axis' unit, speeds per second of wall time.
struct AxisConfig {
  double offset = 0.0;  ///< position at zero counts
  double low = 0.0;     ///< soft limits, both ends included
  double high = 0.0;
  double speed = 1.0;
  double acceleration = 1.0;
  Duration settle{};    ///< how long the encoder must have stayed in the window
  double window = 0.0;  ///< +- about the target: arrived, and still there while a reading is taken
  Approach approach = Approach::Any;
  double overrun = 0.0;  ///< how far it goes past, to come back from its side: more than its backlash
};

/// The stage as instrument.toml has it.
struct StageConfig {
  stage::RegisterMap registers;                ///< of a stage of drives: the scales of the axes only
  std::optional<stage::DriveStageMap> drives;  ///< when set, the stage is one of drives
  /// Whether the stage latches encoders and monitor over an exposure by itself; without, they are looked at around it.
  bool has_gate = true;
  stage::PerAxis<AxisConfig> axes{};
  /// Whether all axes of a move start and arrive together, on a straight line in axis space; else each goes its own
  /// way.
  bool coordinated = false;
  KinematicsConfig kinematics;      ///< how axes make directions
  std::optional<KeepOut> keep_out;  ///< what must not meet on any path; off unless named
  Duration reply_timeout{};         ///< of one exchange on the wire
  Duration homing_time{};           ///< the longest that homing may take
  Duration shutter_time{};          ///< the longest that a shutter may take
  Duration heartbeat_timeout{};     ///< the stage stops when it has not heard from the daemon for so long
  double deadline_factor = 1.5;     ///< a move may take so many times its computed time
  Duration deadline_margin{};       ///< plus this

  [[nodiscard]] const AxisConfig& axis(stage::Axis a) const { return axes[stage::index_of(a)]; }
};

/// Position from counts, and back to the nearest count.
[[nodiscard]] double position_of(const StageConfig& config, stage::Axis axis, std::int64_t counts);
[[nodiscard]] std::int64_t counts_of(const StageConfig& config, stage::Axis axis, double position);

}  // namespace gonio::drivers
