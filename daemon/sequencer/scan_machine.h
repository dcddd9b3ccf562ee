#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// What changes the state of a scan.
enum class ScanEvent : std::uint8_t {
  Start,        ///< its turn has come
  Prepared,     ///< devices verified
  Hold,         ///< the set of holds is no longer empty, and the item in hand is done
  Resume,       ///< the set was emptied
  Complete,     ///< every item is decided
  Finish,       ///< asked to end early
  Parked,       ///< closing dark taken, shutters closed
  ParkedEarly,  ///< the same, items left
  Abort,
  Fail,
  Found,  ///< not over at start-up: nobody knows what was done last
};
inline constexpr std::array<ScanEvent, 11> kAllScanEvents{ScanEvent::Start,  ScanEvent::Prepared,    ScanEvent::Hold,
                                                          ScanEvent::Resume, ScanEvent::Complete,    ScanEvent::Finish,
                                                          ScanEvent::Parked, ScanEvent::ParkedEarly, ScanEvent::Abort,
                                                          ScanEvent::Fail,   ScanEvent::Found};
[[nodiscard]] std::string_view scan_event_name(ScanEvent event);

struct ScanStep {
  ScanState from;
  ScanEvent event;
  ScanState to;
};

/// Every way from one state to another. What is not here is refused.
inline constexpr std::array kScanSteps{
    ScanStep{ScanState::Queued, ScanEvent::Start, ScanState::Preparing},
    ScanStep{ScanState::Queued, ScanEvent::Abort, ScanState::Aborted},

    ScanStep{ScanState::Preparing, ScanEvent::Prepared, ScanState::Running},
    ScanStep{ScanState::Preparing, ScanEvent::Hold, ScanState::Holding},
    ScanStep{ScanState::Preparing, ScanEvent::Finish, ScanState::Finishing},
    ScanStep{ScanState::Preparing, ScanEvent::Abort, ScanState::Aborted},
    ScanStep{ScanState::Preparing, ScanEvent::Fail, ScanState::Failed},
    ScanStep{ScanState::Preparing, ScanEvent::Found, ScanState::Interrupted},

    ScanStep{ScanState::Running, ScanEvent::Hold, ScanState::Holding},
    ScanStep{ScanState::Running, ScanEvent::Complete, ScanState::Finishing},
    ScanStep{ScanState::Running, ScanEvent::Finish, ScanState::Finishing},
    ScanStep{ScanState::Running, ScanEvent::Abort, ScanState::Aborted},
    ScanStep{ScanState::Running, ScanEvent::Fail, ScanState::Failed},
    ScanStep{ScanState::Running, ScanEvent::Found, ScanState::Interrupted},

    ScanStep{ScanState::Holding, ScanEvent::Resume, ScanState::Preparing},
    ScanStep{ScanState::Holding, ScanEvent::Finish, ScanState::Finishing},
    ScanStep{ScanState::Holding, ScanEvent::Abort, ScanState::Aborted},
    ScanStep{ScanState::Holding, ScanEvent::Fail, ScanState::Failed},
    ScanStep{ScanState::Holding, ScanEvent::Found, ScanState::Interrupted},

    ScanStep{ScanState::Finishing, ScanEvent::Parked, ScanState::Done},
    ScanStep{ScanState::Finishing, ScanEvent::ParkedEarly, ScanState::FinishedEarly},
    ScanStep{ScanState::Finishing, ScanEvent::Hold, ScanState::Holding},
    ScanStep{ScanState::Finishing, ScanEvent::Abort, ScanState::Aborted},
    ScanStep{ScanState::Finishing, ScanEvent::Fail, ScanState::Failed},
    ScanStep{ScanState::Finishing, ScanEvent::Found, ScanState::Interrupted},

    ScanStep{ScanState::Interrupted, ScanEvent::Resume, ScanState::Preparing},
    ScanStep{ScanState::Interrupted, ScanEvent::Hold, ScanState::Holding},
    ScanStep{ScanState::Interrupted, ScanEvent::Abort, ScanState::Aborted},
};

constexpr bool has_no_step_twice() {
  for (std::size_t a = 0; a < kScanSteps.size(); ++a) {
    for (std::size_t b = a + 1; b < kScanSteps.size(); ++b) {
      if (kScanSteps[a].from == kScanSteps[b].from && kScanSteps[a].event == kScanSteps[b].event) return false;
    }
  }
  return true;
}
static_assert(has_no_step_twice(), "a state and an event lead to one state");

/// Where an event leads, or nothing when it is refused in this state.
[[nodiscard]] constexpr std::optional<ScanState> next_state(ScanState from, ScanEvent event) {
  for (const ScanStep& step : kScanSteps) {
    if (step.from == from && step.event == event) return step.to;
  }
  return std::nullopt;
}

/// What a client may ask of one scan.
enum class ScanAsk : std::uint8_t { Pause, PauseNow, Resume, Finish, Abort, Skip, Change, CompleteMissing };
inline constexpr std::array<ScanAsk, 8> kAllScanAsks{ScanAsk::Pause,  ScanAsk::PauseNow,       ScanAsk::Resume,
                                                     ScanAsk::Finish, ScanAsk::Abort,          ScanAsk::Skip,
                                                     ScanAsk::Change, ScanAsk::CompleteMissing};
/// "pause", "complete-missing".
[[nodiscard]] std::string_view scan_ask_name(ScanAsk ask);

/// Whether a state takes it at all; what it needs besides (a hold to resume, an item to skip) is its own matter.
/// `is_aside`: pre-empted, another scan has the instrument.
[[nodiscard]] constexpr bool takes(ScanState state, bool is_aside, ScanAsk ask) {
  if (ask == ScanAsk::CompleteMissing) return is_over(state);
  if (is_over(state)) return false;
  if (ask == ScanAsk::Pause || ask == ScanAsk::PauseNow || ask == ScanAsk::Resume || ask == ScanAsk::Abort) return true;
  if (ask == ScanAsk::Change) return state != ScanState::Finishing;
  const bool has_instrument =
      !is_aside && (state == ScanState::Preparing || state == ScanState::Running || state == ScanState::Holding);
  return has_instrument;  // finish, skip
}

/// The refusal of what a state does not take, or not now: WrongState. `seen` may say more than the state's name;
/// the limit is what the state takes.
[[nodiscard]] Error not_now(ScanId scan, ScanState state, bool is_aside, ScanAsk ask, const std::string& seen = {});

/// The refusal of an event: WrongState, naming the event, the state, and the states that allow it.
[[nodiscard]] Error wrong_state(ScanId scan, ScanState state, ScanEvent event);

}  // namespace gonio::daemon
