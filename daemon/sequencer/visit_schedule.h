#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "base/clock.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// What the instrument does for a scan next.
enum class NextJob : std::uint8_t {
  Dark,
  Reference,  ///< the visit: the standard at the visits' geometry
  Check,      ///< the visit: the sample at the visits' geometry
  Item,
  Nothing,  ///< every item is decided, and no visit is owed
};

/// One kind of visit: how often it is wanted, and when it was there.
struct VisitClock {
  Duration every{};             ///< zero: not by time
  std::optional<Instant> last;  ///< of this run: what happened between two runs is in nobody's hand
  bool is_owed = false;         ///< items were accepted after the last one, of any run
};

struct VisitClocks {
  VisitClock dark;
  VisitClock reference;  ///< without a time: not wanted at all
  VisitClock check;      ///< likewise
};

/// What a visit costs at a point boundary: how long the slowest axis goes out of the way that the arms have to go
/// anyway.
struct Detour {
  Duration here{};
  Duration least_ahead{};  ///< of the boundaries that are still to come before the visit's latest time
};

/// A visit that needs the arms is made within this part of its period about the due time, where its detour is least.
inline constexpr double kVisitSlack = 0.2;
/// The latest time of a visit, counted from the one before.
[[nodiscard]] Duration latest_after(Duration every);

/// Which job is next at a point boundary of a running scan. Each run begins with a dark, then a visit of each kind that
/// is wanted. A dark moves no axis and is made when it is due; the others may come `kVisitSlack` of their period early
/// or late, where `detour` is least (asked for within that time only). A check is judged against the standard: where
/// the plan wants both, nothing is measured between a reference visit and the check after it. When every item is
/// decided, what is owed is visited once more, so that each item has a visit on both sides. Pure.
[[nodiscard]] NextJob next_job(const VisitClocks& clocks, Instant now, bool has_open_item,
                               const std::function<Detour(NextJob)>& detour);

/// The same of a scan that is finishing: visits that are owed, the dark last.
[[nodiscard]] NextJob next_closing_job(const VisitClocks& clocks);

}  // namespace gonio::daemon
