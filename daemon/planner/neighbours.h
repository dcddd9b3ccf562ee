#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/planner/step_price.h"

namespace gonio::daemon {

/// For each place the `count` cheapest others by `price.mean_s`, cheapest first, equal ones by index: [place][count],
/// fewer where there are fewer places. By a tree over the axes (Bentley 1975): n log n.
class Neighbours {
 public:
  Neighbours(std::span<const Place> places, const StepPrice& price, std::size_t count);

  struct Neighbour {
    double price_s = 0.0;
    std::int32_t place = 0;
    friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
  };
  [[nodiscard]] std::span<const Neighbour> of(std::int32_t place) const {
    return std::span(all_).subspan(static_cast<std::size_t>(place) * count_, count_);
  }

 private:
  std::size_t count_;
  std::vector<Neighbour> all_;
};

}  // namespace gonio::daemon
