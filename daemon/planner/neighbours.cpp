#include "daemon/planner/neighbours.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace gonio::daemon {

namespace {

constexpr std::size_t kLeaf = 8;  // places in a leaf: looked through one by one

using Neighbour = Neighbours::Neighbour;

class Tree {
 public:
  Tree(std::span<const Place> places, const StepPrice& price) : places_(places), price_(price), ids_(places.size()) {
    std::iota(ids_.begin(), ids_.end(), 0);
    grow(0, ids_.size());
  }

  // The nearest to `centre`, in order.
  void nearest(std::int32_t centre, std::size_t count, std::vector<Neighbour>& found) const {
    found.clear();
    search(0, centre, count, found);
  }

 private:
  struct Node {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t axis = 0;  ///< of price_.axes()
    double split = 0.0;
    std::size_t above = 0;  ///< the node of what lies above the split; 0: a leaf. Below: the next node
  };

  std::size_t grow(std::size_t begin, std::size_t end) {
    const std::size_t self = nodes_.size();
    nodes_.push_back({.begin = begin, .end = end});
    const auto [axis, width_s] = widest(begin, end);
    if (end - begin <= kLeaf || width_s <= 0.0) return self;
    const std::size_t column = price_.axes()[axis];
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t k) { return ids_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::int32_t a, std::int32_t b) {
      const double x = places_[static_cast<std::size_t>(a)][column];
      const double y = places_[static_cast<std::size_t>(b)][column];
      return x != y ? x < y : a < b;
    });
    nodes_[self].axis = axis;
    nodes_[self].split = places_[static_cast<std::size_t>(ids_[middle])][column];
    grow(begin, middle);
    const std::size_t above = grow(middle, end);
    nodes_[self].above = above;
    return self;
  }

  [[nodiscard]] std::pair<std::size_t, double> widest(std::size_t begin, std::size_t end) const {
    std::pair<std::size_t, double> best{0, 0.0};
    for (std::size_t axis = 0; axis < price_.axes().size(); ++axis) {
      const std::size_t column = price_.axes()[axis];
      double low = places_[static_cast<std::size_t>(ids_[begin])][column];
      double high = low;
      for (std::size_t k = begin + 1; k < end; ++k) {
        const double x = places_[static_cast<std::size_t>(ids_[k])][column];
        low = std::min(low, x);
        high = std::max(high, x);
      }
      const double width_s = price_.least_s(axis, high - low);
      if (width_s > best.second) best = {axis, width_s};
    }
    return best;
  }

  void search(std::size_t at, std::int32_t centre, std::size_t count, std::vector<Neighbour>& found) const {
    const Node& node = nodes_[at];
    if (node.above == 0) return look_through(node, centre, count, found);
    const double beyond = places_[static_cast<std::size_t>(centre)][price_.axes()[node.axis]] - node.split;
    search(beyond < 0.0 ? at + 1 : node.above, centre, count, found);
    const bool is_full = found.size() == count;
    if (is_full && price_.least_s(node.axis, beyond) > found.back().price_s) return;
    search(beyond < 0.0 ? node.above : at + 1, centre, count, found);
  }

  void look_through(const Node& leaf, std::int32_t centre, std::size_t count, std::vector<Neighbour>& found) const {
    const Place& from = places_[static_cast<std::size_t>(centre)];
    for (std::size_t k = leaf.begin; k < leaf.end; ++k) {
      if (ids_[k] == centre) continue;
      const Neighbour candidate{price_.mean_s(from, places_[static_cast<std::size_t>(ids_[k])]), ids_[k]};
      if (found.size() == count && candidate >= found.back()) continue;
      found.insert(std::ranges::upper_bound(found, candidate), candidate);
      if (found.size() > count) found.pop_back();
    }
  }

  std::span<const Place> places_;
  const StepPrice& price_;
  std::vector<std::int32_t> ids_;
  std::vector<Node> nodes_;
};

}  // namespace

Neighbours::Neighbours(std::span<const Place> places, const StepPrice& price, std::size_t count)
    : count_(std::min(count, places.empty() ? 0 : places.size() - 1)) {
  if (count_ == 0) return;
  const Tree tree(places, price);
  all_.reserve(places.size() * count_);
  std::vector<Neighbour> found;
  for (std::size_t k = 0; k < places.size(); ++k) {
    tree.nearest(static_cast<std::int32_t>(k), count_, found);
    all_.insert(all_.end(), found.begin(), found.end());
  }
}

}  // namespace gonio::daemon
