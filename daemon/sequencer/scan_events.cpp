#include "daemon/sequencer/scan_events.h"

#include <nlohmann/json.hpp>
#include <set>

namespace gonio::daemon {

namespace {

using nlohmann::json;

json parts_s(const TimeParts& time) {
  return {{"move_s", in_seconds(time.move)},
          {"settle_s", in_seconds(time.settle)},
          {"expose_s", in_seconds(time.expose)},
          {"read_s", in_seconds(time.read)},
          {"idle_s", in_seconds(time.idle.total())},
          {"idle_by",
           {{"commit_s", in_seconds(time.idle.commit)},
            {"wire_s", in_seconds(time.idle.wire)},
            {"device_s", in_seconds(time.idle.device)},
            {"hold_s", in_seconds(time.idle.hold)},
            {"planning_s", in_seconds(time.idle.planning)}}}};
}

// Text from outside may hold broken UTF-8: it is replaced, never thrown over.
NewEvent event(std::string kind, ScanId scan, std::string who, const json& body) {
  return NewEvent{.kind = std::move(kind),
                  .scan = scan,
                  .who = std::move(who),
                  .json = body.dump(-1, ' ', false, json::error_handler_t::replace)};
}

json transition_body(const ScanTransition& t) {
  return {{"from", scan_state_name(t.from)}, {"to", scan_state_name(t.to)}, {"reason", t.reason}};
}

std::string kind_of(const ScanTransition& t) {
  return "scan-" + std::string(scan_state_name(t.to));
}

// The stage's numbers of the exposures: they tell an exposure from its repetition.
json gate_counts(const std::vector<ReadingRecord>& readings) {
  json counts = json::array();
  for (const ReadingRecord& reading : readings) counts.push_back(reading.gate_count);
  return counts;
}

}  // namespace

NewEvent event_submitted(const NewScan& scan) {
  return event("scan-submitted", 0, scan.who,
               {{"name", scan.name},
                {"sample", scan.sample},
                {"points", scan.planned.points.size()},
                {"blocked", scan.planned.blocked},
                {"merged", scan.planned.merged},
                {"items", scan.planned.items}});
}

NewEvent event_transition(const ScanTransition& t) {
  return event(kind_of(t), t.scan, t.who, transition_body(t));
}

NewEvent event_over(const ScanTransition& t, const Progress& progress) {
  json body = transition_body(t);
  body["points"] = progress.points;
  body["blocked"] = progress.blocked;
  body["merged"] = progress.merged;
  body["items"] = progress.items;
  body["accepted"] = progress.accepted;
  body["skipped"] = progress.skipped;
  body["time"] = parts_s(progress.spent);
  return event(kind_of(t), t.scan, t.who, body);
}

NewEvent event_hold_added(ScanId scan, const Hold& hold) {
  return event("hold-added", scan, hold.owner,
               {{"hold", hold_name(hold.name)}, {"owner", hold.owner}, {"reason", hold.reason}});
}

NewEvent event_holds_cleared(ScanId scan, const std::vector<Hold>& holds, const std::string& who) {
  json names = json::array();
  for (const Hold& hold : holds) names.push_back(hold_name(hold.name));
  return event("holds-cleared", scan, who, {{"holds", names}});
}

NewEvent event_attempt(const NewAttempt& attempt, const Measurement& measurement) {
  json body{{"point", attempt.item.point},
            {"target", target_name(attempt.item.target)},
            {"frames", measurement.used_frames()},
            {"mean_dn", measurement.mean_dn()},
            {"gate_counts", gate_counts(attempt.readings)},
            {"time", parts_s(attempt.time)}};
  if (!attempt.readings.empty()) body["exposure_s"] = in_seconds(attempt.readings.back().settings.exposure);
  if (attempt.error) {
    body["error"] = {{"code", traits(attempt.error->code).name}, {"detail", describe(*attempt.error)}};
  }
  const std::string kind = attempt.outcome == AttemptOutcome::Accepted ? "item-accepted"
                           : attempt.outcome == AttemptOutcome::Failed ? "item-failed"
                                                                       : "item-dropped";
  return event(kind, attempt.scan, "goniod", body);
}

NewEvent event_skipped(const SkipItem& skip) {
  return event("item-skipped", skip.scan, skip.who,
               {{"point", skip.item.point}, {"target", target_name(skip.item.target)}, {"reason", skip.reason}});
}

NewEvent event_visit(const NewVisit& visit) {
  json body{
      {"frames", visit.readings.size()}, {"gate_counts", gate_counts(visit.readings)}, {"time", parts_s(visit.time)}};
  if (visit.level) {
    body["point"] = visit.level->point;
    body["level"] = visit.level->level;
    body["u_relative"] = visit.level->u_relative;
    if (visit.level->drift) body["drift"] = *visit.level->drift;
  }
  return event(std::string(visit_kind_name(visit.kind)) + "-visit", visit.scan, "goniod", body);
}

NewEvent event_reopened(const NewVisit& visit, double drift_limit, std::int64_t kept) {
  std::set<std::int32_t> points;
  for (const ItemKey& item : visit.reopened) points.insert(item.point);
  return event("items-reopened", visit.scan, "goniod",
               {{"visit", visit_kind_name(visit.kind)},
                {"drift", visit.level->drift.value_or(0.0)},
                {"limit", drift_limit},
                {"points", points},
                {"items", visit.reopened.size()},
                {"kept", kept}});
}

NewEvent event_changed(const ChangeScan& change, const ScanPolicy& policy, const ScanTurn& turn,
                       const std::string& who) {
  json body{{"reason", change.reason}};
  if (change.target_snr) body["target_snr"] = {{"from", policy.target_snr}, {"to", *change.target_snr}};
  if (change.max_time) {
    body["max_time_s"] = {{"from", in_seconds(policy.max_time)}, {"to", in_seconds(*change.max_time)}};
  }
  if (change.order) body["order"] = rest_order_name(*change.order);
  if (change.order == RestOrder::Random) body["seed"] = change.seed;
  if (change.priority) body["priority"] = {{"from", turn.priority}, {"to", *change.priority}};
  if (change.start) body["start_utc"] = iso8601(change.start->utc);
  return event("scan-changed", change.scan, who, body);
}

NewEvent event_calibration_used(const UseCalibration& use, const std::string& who) {
  return event("calibration-used", 0, who, {{"version", use.version}, {"in_use", use.in_use}, {"reason", use.reason}});
}

NewEvent event_recompute_asked(const RecomputeScan& recompute, const std::string& who) {
  return event("recompute-asked", recompute.scan, who,
               {{"versions", recompute.versions ? json(*recompute.versions) : json()}});
}

NewEvent event_stop(ScanId scan, const std::string& who, drivers::Epoch epoch) {
  return event("stop", scan, who, {{"epoch", epoch}});
}

}  // namespace gonio::daemon
