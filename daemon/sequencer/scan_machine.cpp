#include "daemon/sequencer/scan_machine.h"

#include <fmt/core.h>

#include <string>

namespace gonio::daemon {

std::string_view scan_event_name(ScanEvent event) {
  constexpr std::array<std::string_view, kAllScanEvents.size()> kNames{
      "start", "prepared", "hold", "resume", "complete", "finish", "parked", "parked-early", "abort", "fail", "found"};
  return kNames[static_cast<std::size_t>(event)];
}

Error wrong_state(ScanId scan, ScanState state, ScanEvent event) {
  std::string allowed;
  for (const ScanStep& step : kScanSteps) {
    if (step.event != event) continue;
    allowed += allowed.empty() ? "" : ", ";
    allowed += scan_state_name(step.from);
  }
  return Error{.code = ErrorCode::WrongState,
               .device = "sequencer",
               .tried = fmt::format("{} scan {}", scan_event_name(event), scan),
               .seen = fmt::format("it is {}", scan_state_name(state)),
               .limit = fmt::format("allowed while {}", allowed)};
}

}  // namespace gonio::daemon
