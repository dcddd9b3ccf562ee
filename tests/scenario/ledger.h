#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/scenario/simulator.h"
#include "tests/scenario/store_copy.h"
#include "tests/support/http_client.h"

namespace gonio::test {

/// What was seen of one scan from life to life of a daemon that is killed again and again, and whether each life kept
/// what the ones before had said. Reports to GoogleTest.
class Ledger {
 public:
  explicit Ledger(long scan) : scan_(scan) {}

  /// Events that a client received from one life, before its end. They must go on where the last ones stopped.
  void hear(const std::vector<ServerEvent>& events);
  /// What the disk holds and what the simulator counted after a life's end. All that was stored or told before must be
  /// there as it was; at most one item may have been exposed in vain for each of the `kills` since the last inspection.
  void inspect(const StoreCopy& store, const SeenExposures& exposures, long kills = 1);
  /// All events, as a client that starts from nothing is told them at the end.
  void expect_retold(const std::vector<ServerEvent>& events) const;

  [[nodiscard]] long last_number() const { return last_number_; }
  /// Exposures of which nothing is stored, and of how many items or visits.
  [[nodiscard]] long exposures_in_vain() const;
  [[nodiscard]] long items_exposed_again() const { return items_exposed_again_; }

 private:
  [[nodiscard]] std::map<std::string, long> exposed_by_item(const StoreCopy& store, const SeenExposures& seen) const;

  long scan_;
  long last_number_ = 0;
  std::map<long, std::string> told_;           ///< number -> data, to the byte
  std::vector<std::string> told_items_;        ///< accepted, as their events said
  std::map<std::string, std::string> stored_;  ///< accepted items, to the bit
  std::map<std::string, long> in_vain_;        ///< exposures without a row, by item
  long items_exposed_again_ = 0;
};

}  // namespace gonio::test
