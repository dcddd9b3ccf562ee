// What changes in the rest of a scan: its limits, its order, its turn.
#include <fmt/core.h>

#include <algorithm>
#include <random>
#include <unordered_map>
#include <utility>

#include "daemon/sequencer/scan_events.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

namespace {

constexpr double kLeastSnr = 1.0;
constexpr double kMostSnr = 1e6;
constexpr Duration kMostTime = std::chrono::hours(1);

Error out_of_limits(const ActiveScan& changed, std::string field, std::string seen, std::string limit) {
  return Error{.code = ErrorCode::OutOfLimits,
               .device = "sequencer",
               .tried = fmt::format("change {} of scan {}", field, changed.id),
               .seen = std::move(seen),
               .limit = std::move(limit),
               .where = InputLocation{"", 0, std::move(field)}};
}

Duration longest_in_use(const ActiveScan& changed) {
  Duration longest = changed.policy.exposures.empty() ? Duration::zero() : changed.policy.exposures.back();
  const auto& rungs = changed.chooser.rungs();
  if (changed.highest_rung) longest = std::max(longest, rungs[*changed.highest_rung]);
  if (changed.job && changed.job->measurement) longest = std::max(longest, rungs[changed.job->measurement->rung()]);
  return longest;
}

// Nothing when it may be done.
std::optional<Error> refusal(const ActiveScan& changed, const ChangeScan& change, bool has_power_meter) {
  if (change.target_snr && !(*change.target_snr >= kLeastSnr && *change.target_snr <= kMostSnr)) {
    return out_of_limits(changed, "target_snr", fmt::format("{}", *change.target_snr), "1 to 1e6");
  }
  if (change.max_time) {
    // Each exposure in use needs its closing dark: none of them may go away.
    const Duration least = has_power_meter ? Duration(1) : std::max(Duration(1), longest_in_use(changed));
    if (*change.max_time < least || *change.max_time > kMostTime) {
      return out_of_limits(changed, "max_time_s", fmt::format("{} s", in_seconds(*change.max_time)),
                           fmt::format("{} s, the longest exposure in use, to 3600 s", in_seconds(least)));
    }
  }
  if (change.priority && std::abs(*change.priority) > kHighestPriority) {
    return out_of_limits(changed, "priority", fmt::format("{}", *change.priority), "-100 to 100");
  }
  if (change.start && changed.state != ScanState::Queued) {
    return not_now(changed.id, changed.state, false, ScanAsk::Change, "only a queued scan has a start time");
  }
  const bool is_empty = !change.target_snr && !change.max_time && !change.order && !change.priority && !change.start;
  if (!is_empty) return std::nullopt;
  return Error{.code = ErrorCode::InvalidInput,
               .device = "sequencer",
               .tried = fmt::format("change scan {}", changed.id),
               .seen = "nothing to change is named",
               .limit = "target_snr, max_time_s, order, priority, start"};
}

// The sender's search takes seconds, in which points are measured: what is left keeps its order.
std::vector<std::int32_t> by_rank_in(const std::vector<std::int32_t>& found, std::vector<std::int32_t> rest) {
  std::unordered_map<std::int32_t, std::size_t> rank;
  for (std::size_t k = 0; k < found.size(); ++k) rank.try_emplace(found[k], k);
  const auto rank_of = [&rank, &found](std::int32_t point) {
    const auto known = rank.find(point);
    return known == rank.end() ? found.size() : known->second;
  };
  std::ranges::stable_sort(rest, {}, rank_of);
  return rest;
}

// Of the points that nothing was measured of. Fisher and Yates (1938), by a generator that is the same everywhere.
std::vector<std::int32_t> in_new_order(std::vector<std::int32_t> rest, RestOrder order, const ChangeScan& change) {
  if (order == RestOrder::AsWritten) std::sort(rest.begin(), rest.end());
  if (order == RestOrder::Reversed) std::reverse(rest.begin(), rest.end());
  if (order == RestOrder::Fastest) return by_rank_in(change.fastest, std::move(rest));
  if (order != RestOrder::Random) return rest;
  std::sort(rest.begin(), rest.end());
  std::mt19937_64 chance(change.seed);
  for (std::size_t left = rest.size(); left > 1; --left) std::swap(rest[left - 1], rest[chance() % left]);
  return rest;
}

}  // namespace

void Sequencer::Impl::run_verb(const Command& c, const ChangeScan& change, Instant now) {
  ActiveScan* changed = addressed(c, change.scan, ScanAsk::Change);
  if (changed == nullptr) return;
  if (const auto error = refusal(*changed, change, config.instrument.detector.power.has_value())) {
    return reply(c.id, failure(*error));
  }
  ScanChange record{.scan = changed->id,
                    .target_snr = change.target_snr,
                    .max_time = change.max_time,
                    .priority = change.priority,
                    .start = change.start};
  if (change.order) record.order = in_new_order(changed->items.untouched(), *change.order, change);
  const NewEvent event = event_changed(change, changed->policy, changed->turn, c.who);
  apply(record, *changed, now);
  const AuditEntry entry = audit(c, ScanAsk::Change, changed->id, event.json);
  commit({.at = now, .writes = {std::move(record), entry}, .events = {event}},
         {.done = [this, id = c.id, scan_id = change.scan](const CommitReceipt&,
                                                           Instant) { reply(id, CommandDone{.scan = scan_id}); },
          .reply_failure_to = c.id});
}

void Sequencer::Impl::apply(const ScanChange& record, ActiveScan& changed, Instant now) {
  ScanPolicy& policy = changed.policy;
  if (record.target_snr) policy.target_snr = *record.target_snr;
  if (record.max_time) policy.max_time = *record.max_time;
  // Exposures that come up need a dark before them.
  const bool has_more = changed.chooser.change_limits(config.instrument.detector, policy.target_snr, policy.max_time);
  if (has_more) changed.last_dark.reset();
  if (record.priority) changed.turn.priority = *record.priority;
  if (record.start) changed.turn.start = record.start;
  if (record.order.empty()) return;
  // An item whose arms are only on their way is chosen anew; nothing of it is lost.
  const bool only_moves = is_active(changed) && changed.job && changed.job->kind == Job::Kind::Item &&
                          changed.job->phase != Job::Phase::Exposing &&
                          (!changed.job->measurement || changed.job->measurement->readings().empty());
  if (only_moves) drop_job(now);
  changed.items.reorder(record.order);
  changed.way = {};  // looked at anew
}

}  // namespace gonio::daemon
