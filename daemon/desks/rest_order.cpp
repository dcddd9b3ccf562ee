#include "daemon/desks/rest_order.h"

#include <limits>
#include <utility>

#include "daemon/planner/measuring_order.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

Result<std::vector<std::int32_t>> fastest_rest(StoreReader& store, ScanId scan, const Instrument& instrument) {
  const Result<ScanTexts> texts = store.texts(scan);
  if (!texts) return failure(texts.error());
  Result<api::Plan> plan = api::parse_plan(texts->plan, texts->plan_file, texts->plan_parts);
  if (!plan) return failure(plan.error());
  const auto all = store.points(scan, -1, std::numeric_limits<int>::max());
  if (!all) return failure(all.error());
  plan->order = api::OrderStrategy::Fastest;
  std::vector<ScanPoint> points;
  bool has_rest = false;
  for (const PointInfo& info : *all) {
    points.push_back(info.point);
    points.back().blocked = info.point.blocked || !info.sample_outcome.empty() || !info.reference_outcome.empty();
    has_rest = has_rest || !points.back().blocked;
  }
  if (!has_rest) return std::vector<std::int32_t>{};
  Result<MeasuringOrder> found = measuring_order(*plan, instrument, points);
  if (!found) return failure(found.error());
  return std::move(found->order);
}

}  // namespace gonio::daemon
