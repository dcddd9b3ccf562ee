#include "daemon/planner/snake.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace gonio::daemon {

namespace {

constexpr double kSameRow = 1e-6;  // of an axis' unit: computed angles of one row differ by rounding

// For each place the number of its row along an axis, from the side that is nearer to the first place.
std::vector<std::int32_t> rows_along(std::span<const Place> places, std::size_t axis) {
  std::vector<std::int32_t> by_value(places.size());
  std::iota(by_value.begin(), by_value.end(), 0);
  const auto value = [&](std::int32_t k) { return places[static_cast<std::size_t>(k)][axis]; };
  std::ranges::sort(by_value, [&](std::int32_t a, std::int32_t b) { return value(a) < value(b); });
  const double home = places.front()[axis];
  if (value(by_value.back()) - home < home - value(by_value.front())) std::ranges::reverse(by_value);
  std::vector<std::int32_t> row(places.size());
  std::int32_t rows = 0;
  for (std::size_t k = 1; k < by_value.size(); ++k) {
    if (std::abs(value(by_value[k]) - value(by_value[k - 1])) > kSameRow) ++rows;
    row[static_cast<std::size_t>(by_value[k])] = rows;
  }
  return row;
}

class Snake {
 public:
  explicit Snake(std::vector<std::vector<std::int32_t>> rows) : rows_(std::move(rows)) {}

  std::vector<std::int32_t> walk(const std::vector<std::size_t>& nesting, std::size_t places) {
    nesting_ = &nesting;
    is_backwards_.assign(nesting.size(), false);
    order_.resize(places - 1);
    std::iota(order_.begin(), order_.end(), 1);
    lay(0, 0, order_.size());
    return order_;
  }

 private:
  // Each time that an axis is entered it is walked the other way.
  void lay(std::size_t level, std::size_t begin, std::size_t end) {
    if (level == nesting_->size() || end - begin < 1) return;
    const auto& row = rows_[(*nesting_)[level]];
    const auto at = [&](std::size_t k) { return row[static_cast<std::size_t>(order_[k])]; };
    const bool back = is_backwards_[level];
    is_backwards_[level] = !back;
    std::sort(order_.begin() + static_cast<std::ptrdiff_t>(begin), order_.begin() + static_cast<std::ptrdiff_t>(end),
              [&](std::int32_t a, std::int32_t b) {
                const std::int32_t x = row[static_cast<std::size_t>(a)];
                const std::int32_t y = row[static_cast<std::size_t>(b)];
                if (x != y) return back ? x > y : x < y;
                return a < b;
              });
    for (std::size_t first = begin; first < end;) {
      std::size_t next = first + 1;
      while (next < end && at(next) == at(first)) ++next;
      lay(level + 1, first, next);
      first = next;
    }
  }

  std::vector<std::vector<std::int32_t>> rows_;  // [axis of the price][place]
  const std::vector<std::size_t>* nesting_ = nullptr;
  std::vector<bool> is_backwards_;
  std::vector<std::int32_t> order_;
};

}  // namespace

double walk_s(std::span<const Place> places, std::span<const std::int32_t> order, const StepPrice& price) {
  double sum_s = 0.0;
  std::size_t at = 0;
  for (const std::int32_t next : order) {
    const double weight = at == 0 ? 0.5 : 1.0;
    sum_s += weight * price.mean_s(places[at], places[static_cast<std::size_t>(next)]);
    at = static_cast<std::size_t>(next);
  }
  return sum_s;
}

std::vector<std::int32_t> best_snake(std::span<const Place> places, const StepPrice& price) {
  std::vector<std::vector<std::int32_t>> rows;
  for (const std::size_t axis : price.axes()) rows.push_back(rows_along(places, axis));
  std::vector<std::size_t> nesting(rows.size());
  std::iota(nesting.begin(), nesting.end(), 0);
  Snake snake(std::move(rows));
  std::vector<std::int32_t> best;
  double best_s = std::numeric_limits<double>::infinity();
  do {
    std::vector<std::int32_t> order = snake.walk(nesting, places.size());
    const double price_s = walk_s(places, order, price);
    if (price_s >= best_s) continue;
    best_s = price_s;
    best = std::move(order);
  } while (std::next_permutation(nesting.begin(), nesting.end()));
  return best;
}

}  // namespace gonio::daemon
