#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "reflectance/direction/direction_pair.h"
#include "reflectance/measured/compare_scans.h"

namespace gonio::reflectance {

/// Finds geometries again within a tolerance of arc.
class GeometryIndex {
 public:
  explicit GeometryIndex(const CompareOptions& options);

  /// The nearest that was added and is not taken; absent where none lies within the tolerance.
  [[nodiscard]] std::optional<std::size_t> nearest(const DirectionPair& pair) const;
  void add(const DirectionPair& pair, std::size_t id);
  /// Leaves it out from now on.
  void take(std::size_t id) { is_taken_[id] = true; }

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;  ///< of the two thetas
  [[nodiscard]] Cell cell_of(const DirectionPair& pair) const;
  [[nodiscard]] double distance(const DirectionPair& a, const DirectionPair& b) const;

  CompareOptions options_;
  double width_;
  std::multimap<Cell, std::size_t> cells_;
  std::map<std::size_t, DirectionPair> pairs_;
  std::map<std::size_t, bool> is_taken_;
};

}  // namespace gonio::reflectance
