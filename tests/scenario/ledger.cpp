#include "tests/scenario/ledger.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/scenario/bench.h"

namespace gonio::test {
namespace {

// Nearer than any two planned points are to each other, farther than any error of the arms.
bool is_near(double a_deg, double b_deg) {
  return std::abs(std::remainder(a_deg - b_deg, 360.0)) < 0.3;
}

}  // namespace

void Ledger::hear(const std::vector<ServerEvent>& events) {
  EXPECT_TRUE(is_gapless_from(last_number_ + 1, events)) << "after event " << last_number_;
  for (const ServerEvent& event : events) {
    EXPECT_TRUE(told_.emplace(event.number, event.data).second) << "event " << event.number << " came twice";
    last_number_ = event.number;
  }
  for (std::string& item : accepted_items(events)) told_items_.push_back(std::move(item));
}

std::map<std::string, long> Ledger::exposed_by_item(const StoreCopy& store, const SeenExposures& seen) const {
  std::map<std::string, long> exposed{{"dark", seen.dark}};
  const std::map<long, StoredPoint> points = store.points(scan_);
  for (const ExposedPlace& place : seen.lit) {
    std::string item = "no planned point";
    for (const auto& [index, point] : points) {
      if (!is_near(point.theta_i_deg, place.theta_i_deg) || !is_near(point.theta_r_deg, place.theta_r_deg)) continue;
      // At theta_r = 0 the azimuth says nothing; the plan has one point there.
      if (point.theta_r_deg > 0.0 && !is_near(point.phi_r_deg, place.phi_r_deg)) continue;
      item = std::to_string(index) + ' ' + place.station;
    }
    exposed[item] += place.count;
  }
  return exposed;
}

void Ledger::inspect(const StoreCopy& store, const SeenExposures& exposures, long kills) {
  EXPECT_EQ(store.integrity(), "ok");
  const std::vector<long> numbers = store.event_numbers();
  EXPECT_EQ(numbers.size(), static_cast<std::size_t>(numbers.empty() ? 0 : numbers.back())) << "events have a gap";
  EXPECT_GE(static_cast<long>(numbers.size()), last_number_) << "an event that was told is not stored";

  const std::map<std::string, std::string> now = store.accepted_items();
  for (const auto& [item, content] : stored_) {
    const auto found = now.find(item);
    if (found == now.end()) {
      ADD_FAILURE() << "item " << item << " is lost";
    } else {
      EXPECT_EQ(found->second, content) << "item " << item << " has changed";
    }
  }
  for (const std::string& item : told_items_) EXPECT_TRUE(now.contains(item)) << "item " << item << " was told";
  stored_ = now;

  long items = 0;
  const std::map<std::string, long> rows = store.exposures();
  for (const auto& [item, count] : exposed_by_item(store, exposures)) {
    const auto stored_rows = rows.find(item);
    const long in_vain = count - (stored_rows == rows.end() ? 0 : stored_rows->second);
    EXPECT_GE(in_vain, in_vain_[item]) << item << ": more readings are stored than were exposed";
    if (in_vain > in_vain_[item]) ++items;
    in_vain_[item] = in_vain;
  }
  EXPECT_LE(items, kills) << "one kill may cost one item, or one visit, in hand";
  items_exposed_again_ += items;
}

void Ledger::expect_retold(const std::vector<ServerEvent>& events) const {
  EXPECT_TRUE(is_gapless_from(1, events));
  std::map<long, std::string> retold;
  for (const ServerEvent& event : events) retold[event.number] = event.data;
  for (const auto& [number, data] : told_) EXPECT_EQ(retold[number], data) << "event " << number;
  std::map<std::string, int> times;
  for (const std::string& item : accepted_items(events)) {
    EXPECT_EQ(++times[item], 1) << "item " << item << " was accepted more than once";
  }
}

long Ledger::exposures_in_vain() const {
  return std::accumulate(in_vain_.begin(), in_vain_.end(), 0L,
                         [](long sum, const auto& entry) { return sum + entry.second; });
}

}  // namespace gonio::test
