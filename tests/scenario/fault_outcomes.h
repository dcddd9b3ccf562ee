#pragma once

#include <array>
#include <string_view>

namespace gonio::test {

/// What an operator sees of a fault in mid-scan.
enum class FaultOutcome : std::uint8_t {
  Unnoticed,  ///< nothing, and nothing is wrong
  Retried,    ///< an attempt failed with the error, the next one is right
  Held,       ///< the scan waits with the error, and goes on once the cause is gone
};
inline constexpr std::array<std::string_view, 3> kFaultOutcomeNames{"unnoticed", "retried", "held"};

/// One row: a fault by name, and what becomes of a scan.
struct FaultRow {
  std::string_view name;  ///< of sim/faults/fault_table.h
  std::string_view keys;  ///< of the control socket, beside the name: "\"after\":2"
  FaultOutcome outcome;
  std::string_view hold;  ///< the hold's name
  std::string_view says;  ///< what stands in the attempt's error, or in the hold's reason
  std::string_view wire = "tcp";
};

inline constexpr std::array kFaultRows{
    FaultRow{"reply-lost", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"reply-late", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"reply-torn", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"reply-duplicated", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"reply-stale", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"reply-wrong-unit", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"reply-wrong-transaction", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"reply-bad-crc", R"("after":1)", FaultOutcome::Unnoticed, "", "", "rtu"},
    FaultRow{"reply-exception", R"("after":1)", FaultOutcome::Held, "device", "refused"},
    FaultRow{"stage-reset", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"stage-silent", R"("after":1)", FaultOutcome::Held, "device", "no answer to anything for"},
    FaultRow{"stage-refuse", R"("after":1)", FaultOutcome::Held, "device", "unreachable"},
    FaultRow{"stage-power-cycle", R"("after":0)", FaultOutcome::Held, "device", "boot counter"},
    FaultRow{"interlock-open", R"("after":0)", FaultOutcome::Held, "door", "interlock"},
    FaultRow{"encoder-jump", R"("after":0)", FaultOutcome::Retried, "", "theta_r"},
    FaultRow{"missed-steps", R"("after":0)", FaultOutcome::Retried, "", "theta_r is at"},
    FaultRow{"limit-hit", R"("after":0)", FaultOutcome::Held, "device", "limit switch"},
    FaultRow{"axis-blocked", R"("after":0)", FaultOutcome::Held, "device", "following error"},
    FaultRow{"trigger-ignored", R"("after":1)", FaultOutcome::Retried, "", "no frame"},
    FaultRow{"frame-saturated", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"frame-lost", R"("after":1)", FaultOutcome::Retried, "", "no frame"},
    FaultRow{"frame-late", R"("after":1)", FaultOutcome::Retried, "", "no frame"},
    FaultRow{"frame-duplicated", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"frame-stale", R"("after":1)", FaultOutcome::Retried, "", "frame"},
    FaultRow{"packets-lost", R"("after":1)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"packets-gone", R"("after":1)", FaultOutcome::Retried, "", "packets missing"},
    FaultRow{"camera-silent", R"("after":1)", FaultOutcome::Held, "device", "detector"},
    FaultRow{"control-taken", R"("after":1)", FaultOutcome::Held, "device", "detector"},
    FaultRow{"lamp-step", R"("after":1,"by_percent":30)", FaultOutcome::Unnoticed, "", ""},
    FaultRow{"lamp-step", R"("after":1,"by_percent":-90)", FaultOutcome::Held, "lamp", "limits 0.2"},
    FaultRow{"lamp-off", R"("after":1)", FaultOutcome::Held, "lamp", "lamp monitor 0.0"},
    FaultRow{"monitor-dead", R"("after":1)", FaultOutcome::Held, "lamp", "lamp monitor 0.0"},
    FaultRow{"monitor-stuck", R"("after":1)", FaultOutcome::Held, "lamp", "lamp monitor"},
};

}  // namespace gonio::test
