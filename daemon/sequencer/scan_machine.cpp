#include "daemon/sequencer/scan_machine.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "daemon/sequencer/command.h"

namespace gonio::daemon {

std::string_view scan_event_name(ScanEvent event) {
  constexpr std::array<std::string_view, kAllScanEvents.size()> kNames{
      "start", "prepared", "hold", "resume", "complete", "finish", "parked", "parked-early", "abort", "fail", "found"};
  return kNames[static_cast<std::size_t>(event)];
}

std::string_view scan_ask_name(ScanAsk ask) {
  constexpr std::array<std::string_view, kAllScanAsks.size()> kNames{
      "pause", "pause --now", "resume", "finish", "abort", "skip", "change", "complete-missing"};
  return kNames[static_cast<std::size_t>(ask)];
}

Error not_now(ScanId scan, ScanState state, bool is_aside, ScanAsk ask, const std::string& seen) {
  std::string allowed;
  for (const ScanAsk other : kAllScanAsks) {
    if (other == ask || !takes(state, is_aside, other)) continue;
    allowed += allowed.empty() ? "" : ", ";
    allowed += scan_ask_name(other);
  }
  const std::string_view word = is_aside ? "preempted" : scan_state_name(state);
  return Error{.code = ErrorCode::WrongState,
               .device = "sequencer",
               .tried = fmt::format("{} scan {}", scan_ask_name(ask), scan),
               .seen = seen.empty() ? fmt::format("it is {}", word) : fmt::format("it is {}: {}", word, seen),
               .limit = fmt::format("allowed now: {}", allowed.empty() ? "nothing else" : allowed)};
}

namespace {
constexpr std::array<std::string_view, 4> kRestOrderNames{"as-written", "reversed", "random", "fastest"};
}  // namespace

std::string_view rest_order_name(RestOrder order) {
  return kRestOrderNames[static_cast<std::size_t>(order)];
}
std::optional<RestOrder> rest_order_from_name(std::string_view name) {
  const auto* found = std::find(kRestOrderNames.begin(), kRestOrderNames.end(), name);
  if (found == kRestOrderNames.end()) return std::nullopt;
  return static_cast<RestOrder>(found - kRestOrderNames.begin());
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
