// What counts as calibration, and scans computed anew: the sequencer only makes both durable, in its order of commands;
// who publishes the events computes.
#include <fmt/core.h>

#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

void Sequencer::Impl::run_verb(const Command& c, const UseCalibration& use, Instant now) {
  const UseCalibrationVersion record{.version = use.version, .in_use = use.in_use, .who = c.who, .reason = use.reason};
  const AuditEntry entry{.who = c.who,
                         .action = use.in_use ? "use calibration" : "end use of calibration",
                         .detail = fmt::format("version {}: {}", use.version, use.reason)};
  commit({.at = now, .writes = {record, entry}, .events = {event_calibration_used(use, c.who)}},
         {.done = [this, id = c.id](const CommitReceipt&, Instant) { reply(id, CommandDone{}); },
          .reply_failure_to = c.id});
}

void Sequencer::Impl::run_verb(const Command& c, const RecomputeScan& recompute, Instant now) {
  const AuditEntry entry{.who = c.who, .action = "recompute", .detail = fmt::format("scan {}", recompute.scan)};
  commit({.at = now, .writes = {entry}, .events = {event_recompute_asked(recompute, c.who)}},
         {.done = [this, id = c.id, scan_id = recompute.scan](const CommitReceipt&,
                                                              Instant) { reply(id, CommandDone{.scan = scan_id}); },
          .reply_failure_to = c.id});
}

}  // namespace gonio::daemon
