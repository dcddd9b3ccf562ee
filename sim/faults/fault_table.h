#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string_view>

namespace gonio::sim {

/// Every way in which the simulated instrument can be made to fail.
enum class FaultKind : std::uint8_t {
  ReplyLost,
  ReplyLate,
  ReplyTorn,
  ReplyDuplicated,
  ReplyStale,
  ReplyWrongUnit,
  ReplyWrongTransaction,
  ReplyBadCrc,
  ReplyException,
  StageReset,
  StageSilent,
  StageRefuse,
  StagePowerCycle,
  InterlockOpen,
  EncoderJump,
  MissedSteps,
  LimitHit,
  AxisBlocked,
  TriggerIgnored,
  FrameSaturated,
  FrameLost,
  FrameLate,
  FrameDuplicated,
  FrameStale,
  PacketsLost,
  PacketsGone,
  CameraSilent,
  ControlTaken,
  LampStep,
  LampOff,
  MonitorDead,
  MonitorStuck,
  DrivePowerCycle,
  RadiometerStall,
  RadiometerReplyLost,
  RadiometerReplyTorn,
  RadiometerReplyDuplicated,
  RadiometerReplyStale,
  RadiometerNotANumber,
  RadiometerOverload,
  RadiometerUnplugged,
};
inline constexpr std::size_t kFaultKinds = static_cast<std::size_t>(FaultKind::RadiometerUnplugged) + 1;

/// Whose fault it is.
enum class FaultDevice : std::uint8_t { Stage, Axis, Camera, Radiometer, Lamp };
inline constexpr std::array<std::string_view, 5> kFaultDeviceNames{"stage", "axis", "camera", "radiometer", "lamp"};

/// What a fault waits for, and `after` counts.
enum class FaultMoment : std::uint8_t {
  Exchange,  ///< a request on the stage's wire
  Move,      ///< a motion that the stage has accepted; the fault comes half way through it
  Exposure,  ///< a trigger of the camera; on the bench, the middle of the exposure
  Frame,     ///< a frame that is ready to be sent
  Reply,     ///< a reply that a radiometer is about to send
  Sample,    ///< a value that a radiometer is about to say
};
inline constexpr std::array<std::string_view, 6> kFaultMomentNames{"exchange", "move",  "exposure",
                                                                   "frame",    "reply", "sample"};

/// Which requests on the stage's wire a fault is meant for.
enum class ExchangeKind : std::uint8_t { Look, Motion, Shutters, Heartbeat, Any };
inline constexpr std::array<std::string_view, 5> kExchangeNames{"look", "motion", "shutters", "heartbeat", "any"};

/// Which radiometer a fault is meant for.
enum class FaultRole : std::uint8_t { Detector, Monitor };
inline constexpr std::array<std::string_view, 2> kFaultRoleNames{"detector", "monitor"};

/// What can be said about a fault beyond its name. Times are wall time: they meet the patience of a daemon.
enum class FaultParameter : std::uint8_t { Axis, Exchange, By, ByPercent, Code, Packets, LateWallS, ForWallS, Role };
inline constexpr std::size_t kFaultParameters = 9;

struct FaultParameterTraits {
  FaultParameter parameter;
  std::string_view key;
  double fallback;
  double least;
  double most;
  std::string_view what;
};
inline constexpr double kUntilOff = std::numeric_limits<double>::infinity();
inline constexpr std::array<FaultParameterTraits, kFaultParameters> kFaultParameterTable{{
    {FaultParameter::Axis, "axis", 1.0, 0.0, 5.0,
     "theta_i, theta_r (unless said), phi_r, phi_i, carriage, filter_wheel"},
    {FaultParameter::Exchange, "exchange", 0.0, 0.0, 4.0, "look (unless said), motion, shutters, heartbeat, any"},
    {FaultParameter::By, "by", 1.0, -1000.0, 1000.0, "how far, in the axis' own unit"},
    {FaultParameter::ByPercent, "by_percent", 50.0, -100.0, 10000.0, "change of the output, in per cent of it"},
    {FaultParameter::Code, "code", 4.0, 1.0, 255.0, "the exception code"},
    {FaultParameter::Packets, "packets", 2.0, 1.0, 100000.0, "how many, from the second on"},
    {FaultParameter::LateWallS, "late_wall_s", 1.5, 0.0, 60.0, "how late, seconds of wall time"},
    {FaultParameter::ForWallS, "for_wall_s", kUntilOff, 0.0, 86400.0, "how long, seconds of wall time; else until off"},
    {FaultParameter::Role, "role", 0.0, 0.0, 1.0, "of the radiometer: detector (unless said), monitor"},
}};

/// A set of parameters.
class FaultParameters {
 public:
  constexpr FaultParameters(std::initializer_list<FaultParameter> parameters) {
    for (const FaultParameter p : parameters) bits_ |= 1U << static_cast<unsigned>(p);
  }
  [[nodiscard]] constexpr bool has(FaultParameter p) const { return (bits_ >> static_cast<unsigned>(p) & 1U) != 0; }

 private:
  unsigned bits_ = 0;
};

/// What a fault is, wherever one is named: scene files, the control socket, `goniosim --list-faults`, the operators'
/// table, the scenarios.
struct FaultTraits {
  FaultKind kind;
  std::string_view name;
  FaultDevice device;
  FaultMoment moment;
  bool may_come_at_once;  ///< without `after` it does not wait for its moment
  bool lasts;             ///< it has an end: after `for_wall_s`, or when it is told off
  FaultParameters parameters;
  std::string_view what;
};

namespace detail {
using P = FaultParameter;
using D = FaultDevice;
using M = FaultMoment;
}  // namespace detail

inline constexpr std::array<FaultTraits, kFaultKinds> kFaultTable{{
    {FaultKind::ReplyLost,
     "reply-lost",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange},
     "the request is obeyed, and its reply never comes"},
    {FaultKind::ReplyLate,
     "reply-late",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange, detail::P::LateWallS},
     "the request is obeyed, and its reply comes late"},
    {FaultKind::ReplyTorn,
     "reply-torn",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange},
     "half of the reply's bytes come"},
    {FaultKind::ReplyDuplicated,
     "reply-duplicated",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange},
     "the reply comes twice"},
    {FaultKind::ReplyStale,
     "reply-stale",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange},
     "the reply before comes once more instead, as the right one to look at"},
    {FaultKind::ReplyWrongUnit,
     "reply-wrong-unit",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange},
     "the reply bears another unit id"},
    {FaultKind::ReplyWrongTransaction,
     "reply-wrong-transaction",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange},
     "the reply bears another transaction id (Modbus TCP)"},
    {FaultKind::ReplyBadCrc,
     "reply-bad-crc",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange},
     "the reply's checksum is wrong (Modbus RTU)"},
    {FaultKind::ReplyException,
     "reply-exception",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange, detail::P::Code},
     "the request is not obeyed, and answered by an exception"},
    {FaultKind::StageReset,
     "stage-reset",
     detail::D::Stage,
     detail::M::Exchange,
     false,
     false,
     {detail::P::Exchange},
     "the request is obeyed, and every connection is reset; a serial adapter goes and is back at once"},
    {FaultKind::StageSilent,
     "stage-silent",
     detail::D::Stage,
     detail::M::Exchange,
     true,
     true,
     {detail::P::Exchange, detail::P::ForWallS},
     "requests are neither obeyed nor answered"},
    {FaultKind::StageRefuse,
     "stage-refuse",
     detail::D::Stage,
     detail::M::Exchange,
     true,
     true,
     {detail::P::Exchange, detail::P::ForWallS},
     "nobody gets through: connections are closed, a serial adapter is out"},
    {FaultKind::StagePowerCycle,
     "stage-power-cycle",
     detail::D::Stage,
     detail::M::Move,
     true,
     false,
     {},
     "the stage loses its power and boots: home, counters and what moved are gone"},
    {FaultKind::InterlockOpen,
     "interlock-open",
     detail::D::Stage,
     detail::M::Move,
     true,
     true,
     {detail::P::ForWallS},
     "the door opens: every axis brakes, and no motion is taken"},
    {FaultKind::EncoderJump,
     "encoder-jump",
     detail::D::Axis,
     detail::M::Exposure,
     true,
     false,
     {detail::P::Axis, detail::P::By},
     "the encoder slips: it shows another position, and the axis stands where it was"},
    {FaultKind::MissedSteps,
     "missed-steps",
     detail::D::Axis,
     detail::M::Move,
     false,
     false,
     {detail::P::Axis, detail::P::By},
     "the motor turns and the load does not follow all the way; the encoder says so"},
    {FaultKind::LimitHit,
     "limit-hit",
     detail::D::Axis,
     detail::M::Move,
     true,
     false,
     {detail::P::Axis},
     "a limit switch closes: every axis brakes, fault word 3"},
    {FaultKind::AxisBlocked,
     "axis-blocked",
     detail::D::Axis,
     detail::M::Move,
     true,
     true,
     {detail::P::Axis, detail::P::ForWallS},
     "the axis stands still, whatever its drive does"},
    {FaultKind::TriggerIgnored,
     "trigger-ignored",
     detail::D::Camera,
     detail::M::Exposure,
     false,
     false,
     {},
     "the trigger is acknowledged, and nothing is exposed"},
    {FaultKind::FrameSaturated,
     "frame-saturated",
     detail::D::Camera,
     detail::M::Frame,
     false,
     false,
     {},
     "every pixel is at full scale"},
    {FaultKind::FrameLost,
     "frame-lost",
     detail::D::Camera,
     detail::M::Frame,
     false,
     false,
     {},
     "the exposure was made, and no packet of its frame is sent"},
    {FaultKind::FrameLate,
     "frame-late",
     detail::D::Camera,
     detail::M::Frame,
     false,
     false,
     {detail::P::LateWallS},
     "the frame is sent late"},
    {FaultKind::FrameDuplicated,
     "frame-duplicated",
     detail::D::Camera,
     detail::M::Frame,
     false,
     false,
     {},
     "the frame is sent twice, under its number and under the next"},
    {FaultKind::FrameStale,
     "frame-stale",
     detail::D::Camera,
     detail::M::Frame,
     false,
     false,
     {},
     "the frame before is sent once more instead"},
    {FaultKind::PacketsLost,
     "packets-lost",
     detail::D::Camera,
     detail::M::Frame,
     false,
     false,
     {detail::P::Packets},
     "packets get lost on their first way, and are sent again when asked for"},
    {FaultKind::PacketsGone,
     "packets-gone",
     detail::D::Camera,
     detail::M::Frame,
     false,
     false,
     {detail::P::Packets},
     "packets get lost, and are not sent again"},
    {FaultKind::CameraSilent,
     "camera-silent",
     detail::D::Camera,
     detail::M::Exposure,
     true,
     true,
     {detail::P::ForWallS},
     "the camera's cable is out; back, it is as after a power cycle"},
    {FaultKind::ControlTaken,
     "control-taken",
     detail::D::Camera,
     detail::M::Exposure,
     true,
     true,
     {detail::P::ForWallS},
     "another controller has taken the camera"},
    {FaultKind::LampStep,
     "lamp-step",
     detail::D::Lamp,
     detail::M::Exposure,
     true,
     true,
     {detail::P::ByPercent, detail::P::ForWallS},
     "the lamp's output steps, and its monitor sees it"},
    {FaultKind::LampOff,
     "lamp-off",
     detail::D::Lamp,
     detail::M::Exposure,
     true,
     true,
     {detail::P::ForWallS},
     "the lamp is out"},
    {FaultKind::MonitorDead,
     "monitor-dead",
     detail::D::Lamp,
     detail::M::Exposure,
     true,
     true,
     {detail::P::ForWallS},
     "the lamp's monitor reads nought"},
    {FaultKind::MonitorStuck,
     "monitor-stuck",
     detail::D::Lamp,
     detail::M::Exposure,
     true,
     true,
     {detail::P::ForWallS},
     "the lamp's monitor goes on saying what it said last"},
    {FaultKind::DrivePowerCycle,
     "drive-power-cycle",
     detail::D::Axis,
     detail::M::Move,
     true,
     false,
     {detail::P::Axis},
     "the drive of one axis loses its power and boots: its home is gone (a stage of drives)"},
    {FaultKind::RadiometerStall,
     "radiometer-stall",
     detail::D::Radiometer,
     detail::M::Reply,
     false,
     false,
     {detail::P::Role},
     "Bulk-IN halts instead of the reply"},
    {FaultKind::RadiometerReplyLost,
     "radiometer-reply-lost",
     detail::D::Radiometer,
     detail::M::Reply,
     false,
     false,
     {detail::P::Role},
     "the reply never comes"},
    {FaultKind::RadiometerReplyTorn,
     "radiometer-reply-torn",
     detail::D::Radiometer,
     detail::M::Reply,
     false,
     false,
     {detail::P::Role},
     "half of the reply's bytes come"},
    {FaultKind::RadiometerReplyDuplicated,
     "radiometer-reply-duplicated",
     detail::D::Radiometer,
     detail::M::Reply,
     false,
     false,
     {detail::P::Role},
     "the reply comes, and is ready to be fetched once more"},
    {FaultKind::RadiometerReplyStale,
     "radiometer-reply-stale",
     detail::D::Radiometer,
     detail::M::Reply,
     false,
     false,
     {detail::P::Role},
     "the reply comes under the tag of the request before"},
    {FaultKind::RadiometerNotANumber,
     "radiometer-not-a-number",
     detail::D::Radiometer,
     detail::M::Sample,
     false,
     false,
     {detail::P::Role},
     "the value is \"not a number\", 9.91E37"},
    {FaultKind::RadiometerOverload,
     "radiometer-overload",
     detail::D::Radiometer,
     detail::M::Sample,
     false,
     false,
     {detail::P::Role},
     "the value is an overload, 9.9E37"},
    {FaultKind::RadiometerUnplugged,
     "radiometer-unplugged",
     detail::D::Radiometer,
     detail::M::Reply,
     true,
     true,
     {detail::P::Role, detail::P::ForWallS},
     "its cable is out; back, it is as after a power cycle, under another address"},
}};

[[nodiscard]] constexpr const FaultTraits& traits(FaultKind kind) {
  return kFaultTable[static_cast<std::size_t>(kind)];
}
[[nodiscard]] constexpr std::optional<FaultKind> fault_from_name(std::string_view name) {
  for (const FaultTraits& fault : kFaultTable) {
    if (fault.name == name) return fault.kind;
  }
  return std::nullopt;
}
[[nodiscard]] constexpr const FaultParameterTraits& traits(FaultParameter parameter) {
  return kFaultParameterTable[static_cast<std::size_t>(parameter)];
}

namespace detail {
constexpr bool stands_in_order() {
  for (std::size_t k = 0; k < kFaultTable.size(); ++k) {
    if (static_cast<std::size_t>(kFaultTable[k].kind) != k) return false;
    if (fault_from_name(kFaultTable[k].name) != kFaultTable[k].kind) return false;
  }
  for (std::size_t k = 0; k < kFaultParameterTable.size(); ++k) {
    if (static_cast<std::size_t>(kFaultParameterTable[k].parameter) != k) return false;
  }
  return true;
}
static_assert(stands_in_order(), "each kind once, at its own place, under a name of its own");
}  // namespace detail

}  // namespace gonio::sim
