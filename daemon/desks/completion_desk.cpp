#include "daemon/desks/completion_desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "daemon/desks/plan_desk.h"
#include "daemon/planner/anchor.h"
#include "daemon/planner/planner.h"
#include "daemon/sequencer/scan_machine.h"

namespace gonio::daemon {
namespace {

Error refused(const ScanInfo& info, const std::string& why) {
  return not_now(info.id, info.state, false, ScanAsk::CompleteMissing, why);
}

// Two scans of the same points would be one too many; one that was ended before it had anything does not count.
Result<void> check_not_completed(StoreReader& store, const ScanInfo& info) {
  if (info.completed_by == 0) return {};
  const Result<ScanInfo> other = store.scan(info.completed_by);
  if (!other) return failure(other.error());
  if (is_over(other->state) && other->counts.accepted == 0) return {};
  return failure(
      refused(info, fmt::format("scan {} completes it: what that one lacks is its own to complete", other->id)));
}

bool is_missing(const PointInfo& info, api::ReferenceMode mode) {
  const bool needs_reference = mode == api::ReferenceMode::SameGeometry;
  return !info.point.blocked &&
         (info.sample_outcome != "accepted" || (needs_reference && info.reference_outcome != "accepted"));
}

// Where the standard is visited: in the new scan too, whatever it lacks.
bool is_anchor(const ScanPoint& point, const ScanPolicy& policy) {
  return policy.reference_mode == api::ReferenceMode::Anchor && !point.blocked && point.repeat == 1 &&
         is_at_anchor(point.geometry, policy.anchor);
}

// In the order of measurement of the first scan, with indices and ranks of their own.
Result<PlannedScan> missing_points(StoreReader& store, const ScanInfo& scan) {
  const auto all = store.points(scan.id, -1, std::numeric_limits<int>::max());
  if (!all) return failure(all.error());
  PlannedScan planned{.planner_version = kPlannerVersion};
  std::vector<std::int32_t> rank_then;
  const ScanPolicy& policy = scan.policy;
  const bool lacks_any = std::any_of(all->begin(), all->end(),
                                     [&](const PointInfo& info) { return is_missing(info, policy.reference_mode); });
  for (const PointInfo& info : *all) {
    if (!is_missing(info, policy.reference_mode) && !(lacks_any && is_anchor(info.point, policy))) continue;
    rank_then.push_back(info.point.rank);
    planned.order.push_back(static_cast<std::int32_t>(planned.points.size()));
    planned.points.push_back(info.point);
    planned.points.back().index = planned.order.back();
  }
  std::sort(planned.order.begin(), planned.order.end(), [&rank_then](std::int32_t a, std::int32_t b) {
    return rank_then[static_cast<std::size_t>(a)] < rank_then[static_cast<std::size_t>(b)];
  });
  for (std::size_t rank = 0; rank < planned.order.size(); ++rank) {
    planned.points[static_cast<std::size_t>(planned.order[rank])].rank = static_cast<std::int32_t>(rank);
  }
  planned.asked = std::ssize(planned.points);
  planned.items = items_of(planned.asked, policy.reference_mode);
  return planned;
}

Result<ShelfEntry> standard_in_reach(const ReferenceShelf& shelf, const std::string& serial,
                                     const std::vector<ScanPoint>& points, const ScanPolicy& policy, UtcTime today) {
  Result<ShelfEntry> reference = shelf.find(serial);
  if (!reference) return failure(reference.error());
  GONIO_TRY(reference->standard->check_date(today));
  GONIO_TRY(check_standard_reaches(points, policy.reference_mode, policy.anchor, *reference->standard));
  return reference;
}

NewScan in_the_name_of(const ScanInfo& info, ScanTexts texts, const Instrument& instrument) {
  NewScan scan;
  scan.idempotency_key = fmt::format("completes-{}-{}", info.id, info.completed_by);
  scan.name = info.name;
  scan.campaign = info.campaign;
  scan.sample = info.sample;
  scan.isotropic = info.isotropic;
  scan.policy = info.policy;
  scan.plan_text = std::move(texts.plan);
  scan.plan_file = std::move(texts.plan_file);
  scan.plan_parts = std::move(texts.plan_parts);
  scan.reference_serial = info.reference_serial;
  scan.instrument_text = instrument.text;
  scan.instrument_hash = instrument.sha256;
  scan.turn = {.priority = info.turn.priority, .completes = info.id};
  return scan;
}

}  // namespace

Result<NewScan> completion_of(StoreReader& store, ScanId scan, const Instrument& instrument,
                              const ReferenceShelf& shelf, UtcTime today, const std::string& who) {
  const Result<ScanInfo> info = store.scan(scan);
  if (!info) return failure(info.error());
  if (!takes(info->state, false, ScanAsk::CompleteMissing)) return failure(refused(*info, ""));
  GONIO_TRY(check_not_completed(store, *info));
  if (info->instrument_hash != instrument.sha256) {
    return failure(refused(*info, fmt::format("it was measured by instrument {:.12}, this is {:.12}: submit its plan "
                                              "anew",
                                              info->instrument_hash, instrument.sha256)));
  }
  Result<PlannedScan> planned = missing_points(store, *info);
  if (!planned) return failure(planned.error());
  if (planned->points.empty()) return failure(refused(*info, "no point is missing"));
  Result<ScanTexts> texts = store.texts(scan);
  if (!texts) return failure(texts.error());
  Result<ShelfEntry> reference = standard_in_reach(shelf, info->reference_serial, planned->points, info->policy, today);
  if (!reference) return failure(reference.error());
  NewScan completing = in_the_name_of(*info, std::move(*texts), instrument);
  completing.reference_text = std::move(reference->text);
  completing.planned = std::move(*planned);
  completing.who = who;
  return completing;
}

}  // namespace gonio::daemon
