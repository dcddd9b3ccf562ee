#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace gonio::test {

/// What becomes of a scan.
enum class FaultOutcome : std::uint8_t {
  Unnoticed,  ///< no attempt fails, and nothing is wrong
  Retried,    ///< one attempt fails with the error, the next one is right
  Skipped,    ///< the point in hand is refused, with its reason
  Held,       ///< the scan waits with the reason, and goes on once the cause is gone
};
/// As docs/faults.md says them.
inline constexpr std::array<std::string_view, 4> kFaultOutcomeNames{"unnoticed", "retried", "skipped", "held"};

/// One row: a fault by name, and its outcome in mid-scan.
struct FaultRow {
  std::string_view test;  ///< the test's name
  std::string_view name;  ///< of sim/faults/fault_table.h
  std::string_view keys;  ///< of the control socket, beside the name
  FaultOutcome outcome;
  std::string_view hold;                ///< the hold's name
  std::string_view says;                ///< what stands in the attempt's error, the skip's reason or the hold's
  std::string_view instrument = "tcp";  ///< or "rtu", "drives" (on TCP), "usb" (TCP and two radiometers)
  std::string_view or_says = "";        ///< of a hold, where what is seen first is a race: the other word
};

/// The operators' table in docs/faults.md has a row for each.
inline constexpr std::array kFaultRows{
    FaultRow{"ReplyLost", "reply-lost", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"ReplyLate", "reply-late", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"ReplyTorn", "reply-torn", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"MotionReplyLost", "reply-lost", R"("after":0,"exchange":"motion")", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"ReplyDuplicated", "reply-duplicated", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"ReplyStale", "reply-stale", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"ReplyWrongUnit", "reply-wrong-unit", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"ReplyWrongTransaction", "reply-wrong-transaction", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"ReplyException", "reply-exception", R"("after":1)", FaultOutcome::Held, "device", "device-refused"},
    FaultRow{"StageReset", "stage-reset", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"StageSilent", "stage-silent", R"("after":1)", FaultOutcome::Held, "device", "no answer to anything for"},
    FaultRow{"StageRefuse", "stage-refuse", R"("after":1)", FaultOutcome::Held, "device", "unreachable"},
    FaultRow{"StagePowerCycle", "stage-power-cycle", R"("after":0)", FaultOutcome::Held, "device", "boot counter"},
    FaultRow{"InterlockOpen", "interlock-open", R"("after":0)", FaultOutcome::Held, "door", "the interlock is open"},
    FaultRow{"EncoderJump", "encoder-jump", R"("after":0,"axis":"theta_i","by":8)", FaultOutcome::Retried, "",
             "theta_i at 68.0000 deg when it ended"},
    FaultRow{"EncoderJumpBetweenExposures", "encoder-jump", R"("axis":"theta_i","by":8)", FaultOutcome::Retried, "",
             "theta_i"},
    FaultRow{"MissedSteps", "missed-steps", R"("after":0)", FaultOutcome::Retried, "", "deg and at rest"},
    FaultRow{"LimitHit", "limit-hit", R"("after":0)", FaultOutcome::Held, "device", "limit switch"},
    FaultRow{"AxisBlocked", "axis-blocked", R"("after":0)", FaultOutcome::Held, "device", "following error"},
    FaultRow{"TriggerIgnored", "trigger-ignored", R"("after":1)", FaultOutcome::Retried, "", "no frame"},
    FaultRow{"FrameSaturated", "frame-saturated", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"FrameSaturatedAlways", "frame-saturated", R"("after":0,"times":6)", FaultOutcome::Skipped, "",
             "at full scale"},
    FaultRow{"FrameLost", "frame-lost", R"("after":1)", FaultOutcome::Retried, "", "no frame"},
    FaultRow{"FrameLate", "frame-late", R"("after":1)", FaultOutcome::Retried, "", "no frame"},
    FaultRow{"FrameDuplicated", "frame-duplicated", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"FrameStale", "frame-stale", R"("after":1)", FaultOutcome::Retried, "", "frame"},
    FaultRow{"PacketsLost", "packets-lost", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"PacketsGone", "packets-gone", R"("after":1)", FaultOutcome::Retried, "", "packets missing"},
    FaultRow{"CameraSilent", "camera-silent", R"("after":1)", FaultOutcome::Held, "device", "control-lost", "tcp",
             "unreachable"},
    FaultRow{"ControlTaken", "control-taken", R"("after":1)", FaultOutcome::Held, "device", "control-lost"},
    FaultRow{"LampStepInsideTheBand", "lamp-step", R"("after":1,"by_percent":30)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"LampStepOutOfTheBand", "lamp-step", R"("after":1,"by_percent":-90)", FaultOutcome::Held, "lamp",
             "limits 0.2 to 5"},
    FaultRow{"LampOff", "lamp-off", R"("after":1)", FaultOutcome::Held, "lamp", "limits 0.2 to 5"},
    FaultRow{"MonitorDead", "monitor-dead", R"("after":1)", FaultOutcome::Held, "lamp", "limits 0.2 to 5"},
    FaultRow{"MonitorStuck", "monitor-stuck", R"("after":1)", FaultOutcome::Held, "lamp", "lamp monitor stuck at"},
    FaultRow{"ReplyBadCrc", "reply-bad-crc", R"("after":1)", FaultOutcome::Unnoticed, "", "", "rtu"},
    FaultRow{"SerialReplyStale", "reply-stale", R"("after":1)", FaultOutcome::Unnoticed, "", "", "rtu"},
    FaultRow{"SerialReplyLate", "reply-late", R"("after":1)", FaultOutcome::Unnoticed, "", "", "rtu"},
    FaultRow{"SerialReplyWrongUnit", "reply-wrong-unit", R"("after":1)", FaultOutcome::Unnoticed, "", "", "rtu"},
    FaultRow{"DrivePowerCycle", "drive-power-cycle", R"("after":0)", FaultOutcome::Held, "device", "boot counter",
             "drives"},
    FaultRow{"RadiometerStall", "radiometer-stall", R"("after":1)", FaultOutcome::Retried, "", "device-refused", "usb"},
    FaultRow{"RadiometerReplyLost", "radiometer-reply-lost", R"("after":1)", FaultOutcome::Retried, "", "no reply",
             "usb"},
    FaultRow{"RadiometerReplyTorn", "radiometer-reply-torn", R"("after":1)", FaultOutcome::Retried, "",
             "incomplete-data", "usb"},
    FaultRow{"RadiometerReplyDuplicated", "radiometer-reply-duplicated", R"("after":1)", FaultOutcome::Retried, "",
             "a reply that nobody asked for", "usb"},
    FaultRow{"RadiometerReplyStale", "radiometer-reply-stale", R"("after":1)", FaultOutcome::Retried, "", "stale-data",
             "usb"},
    FaultRow{"RadiometerNotANumber", "radiometer-not-a-number", R"("after":1)", FaultOutcome::Retried, "", "9.91E37",
             "usb"},
    FaultRow{"RadiometerOverload", "radiometer-overload", R"("after":1)", FaultOutcome::Unnoticed, "", "", "usb"},
    FaultRow{"RadiometerUnplugged", "radiometer-unplugged", R"("after":1)", FaultOutcome::Held, "device", "unreachable",
             "usb"},
    FaultRow{"MonitorReplyLost", "radiometer-reply-lost", R"("after":1,"role":"monitor")", FaultOutcome::Retried, "",
             "monitor", "usb"},
    FaultRow{"MonitorNotANumber", "radiometer-not-a-number", R"("after":1,"role":"monitor")", FaultOutcome::Retried, "",
             "9.91E37", "usb"},
    FaultRow{"MonitorOverload", "radiometer-overload", R"("after":1,"role":"monitor")", FaultOutcome::Retried, "",
             "saturated", "usb"},
    FaultRow{"MonitorUnplugged", "radiometer-unplugged", R"("after":1,"role":"monitor")", FaultOutcome::Held, "device",
             "unreachable", "usb"},
};

}  // namespace gonio::test
