#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "sim/faults/fault_plan.h"

namespace gonio::sim {

/// How often a fault has come, will come, and whether it stands.
struct FaultCount {
  unsigned armed = 0;  ///< strikes that are still to come
  unsigned fired = 0;  ///< strikes so far
  bool is_active = false;
};

/// Keeps the faults that are armed and says at each moment which of them strikes. It does nothing to any device: who
/// asks does. Empty, it costs a comparison. Threads: one at a time, as the instrument.
class FaultDesk {
 public:
  static constexpr std::size_t kMostArmed = 1000;

  explicit FaultDesk(const FaultPlan& plan) {
    for (const PlannedFault& fault : plan) (void)arm(fault);
  }

  /// False: too many are armed.
  [[nodiscard]] bool arm(const PlannedFault& fault);
  /// Whatever of this kind is armed comes no more, and what stands is over.
  void end(FaultKind kind);

  /// A moment has come. The first fault that waits for it and that `is_meant` takes strikes; for the others one moment
  /// more has passed. A fault that lasts stands from now on.
  template <class Predicate>
  [[nodiscard]] std::optional<PlannedFault> strike(FaultMoment moment, double scene_s, Instant now,
                                                   Predicate is_meant) {
    std::optional<PlannedFault> struck;
    if (armed_.empty()) return struck;
    for (Armed& armed : armed_) {
      const FaultKind kind = armed.fault.kind;
      const bool waits = traits(kind).moment == moment && !armed.comes_at_once && scene_s >= armed.fault.at_s;
      if (!waits || !is_meant(armed.fault)) continue;
      if (armed.met++ < armed.fault.after.value_or(0) || struck) continue;
      struck = armed.fault;
      fire(armed, now);
    }
    forget_spent();
    return struck;
  }
  /// The next of the faults that wait for no moment, once its time has come.
  [[nodiscard]] std::optional<PlannedFault> take_due(double scene_s, Instant now);
  /// The scene time of the next of those; none.
  [[nodiscard]] std::optional<double> next_due_s() const;

  /// The fault of this kind that stands now.
  [[nodiscard]] const PlannedFault* active(FaultKind kind, Instant now) const;
  [[nodiscard]] FaultCount count(FaultKind kind, Instant now) const;

 private:
  struct Armed {
    PlannedFault fault;
    bool comes_at_once = false;
    unsigned met = 0;
    unsigned fired = 0;
  };
  struct Standing {
    PlannedFault fault;
    std::optional<Instant> until;
  };
  void fire(Armed& armed, Instant now);
  void forget_spent();

  std::vector<Armed> armed_;
  std::array<unsigned, kFaultKinds> fired_{};
  std::array<std::optional<Standing>, kFaultKinds> standing_{};
};

}  // namespace gonio::sim
