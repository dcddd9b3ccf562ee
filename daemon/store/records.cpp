#include "daemon/store/records.h"

#include <algorithm>

namespace gonio::daemon {

namespace {

using calibration::Target;

constexpr std::array<std::string_view, 10> kStateNames{"queued", "preparing",      "running", "holding", "finishing",
                                                       "done",   "finished-early", "aborted", "failed",  "interrupted"};
constexpr std::array<std::string_view, 7> kHoldNames{"operator", "lamp",    "door",     "device",
                                                     "disk",     "restart", "preempted"};
constexpr std::array<std::string_view, 3> kTargetNames{"sample", "reference", "dark"};
constexpr std::array<std::string_view, 3> kVisitKindNames{"dark", "reference", "check"};

// The enum whose name stands at this place of the list.
template <class E, std::size_t N>
std::optional<E> from_name(const std::array<std::string_view, N>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<E>(found - names.begin());
}

}  // namespace

std::string_view scan_state_name(ScanState state) {
  return kStateNames[static_cast<std::size_t>(state)];
}
std::optional<ScanState> scan_state_from_name(std::string_view name) {
  return from_name<ScanState>(kStateNames, name);
}

std::string_view hold_name(HoldName name) {
  return kHoldNames[static_cast<std::size_t>(name)];
}
std::optional<HoldName> hold_from_name(std::string_view name) {
  return from_name<HoldName>(kHoldNames, name);
}

std::string_view target_name(Target target) {
  return kTargetNames[static_cast<std::size_t>(target)];
}
std::optional<Target> target_from_name(std::string_view name) {
  return from_name<Target>(kTargetNames, name);
}

std::string_view visit_kind_name(VisitKind kind) {
  return kVisitKindNames[static_cast<std::size_t>(kind)];
}

ScanPolicy policy_of(const api::Plan& plan) {
  return ScanPolicy{
      .target_snr = plan.target_snr,
      .max_time = plan.max_time,
      .exposures = plan.exposures,
      .block = plan.block,
      .dark_every = plan.dark_every,
      .item_retries = plan.item_retries,
      .on_item_error = plan.on_item_error,
      .on_restart = plan.on_restart,
      .reference_every = plan.reference_every,
      .check_every = plan.check_every,
      .drift_limit = plan.drift_limit,
      .drift_rounds = plan.drift_rounds,
      .reference_mode = plan.reference_mode,
      .anchor = plan.anchor,
      .map_frames = plan.calibration && api::makes_maps(plan.calibration->job) ? plan.calibration->frames : 0};
}

ScanPolicy policy_of(const api::Plan& plan, const PlannedScan& planned) {
  ScanPolicy policy = policy_of(plan);
  if (planned.budget) policy.target_snr = planned.budget->target_snr;
  return policy;
}

}  // namespace gonio::daemon
