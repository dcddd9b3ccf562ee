#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/large_array.h"
#include "calibration/budget.h"

namespace gonio::calibration {

/// The terms of many points' budgets, list after list in large pieces of memory: two lists of its own for each of a
/// million points would cost two million allocations. Points that follow each other mostly have the same components:
/// those stand there once. What it keeps stays where it is, also when the store is moved. Threads: one.
class TermStore {
 public:
  TermStore() = default;
  /// With room for about so many points.
  explicit TermStore(std::size_t points) : piece_(points * kTermsOfAPoint) {}
  TermStore(TermStore&&) = default;
  TermStore& operator=(TermStore&&) = default;

  /// Takes over the budget's terms, both lists one behind the other (make_budget): it refers to the store then.
  void keep(Budget& budget) {
    const std::size_t randoms = budget.random.size();
    const std::size_t all = randoms + budget.shared.size();
    const std::span components(budget.random.components(), all);
    if (!std::ranges::equal(components, last_components_))
      last_components_ = kept(components, kComponentsOfAPiece, components_);
    const auto per_sds = kept(std::span(budget.random.per_sds(), all), piece_, per_sds_);
    budget.random = {last_components_.data(), per_sds.data(), randoms};
    budget.shared = {last_components_.data() + randoms, per_sds.data() + randoms, all - randoms};
  }

  /// Component n of every list becomes numbers[n].
  void renumber(std::span<const std::uint32_t> numbers) {
    for (LargeArray<std::uint32_t>& piece : components_) {
      for (std::uint32_t& component : piece) component = numbers[component];
    }
  }

 private:
  static constexpr std::size_t kTermsOfAPoint = 32;
  static constexpr std::size_t kComponentsOfAPiece = 4096;

  template <class T>
  using Pieces = std::vector<LargeArray<T>>;

  template <class T>
  static std::span<const T> kept(std::span<const T> list, std::size_t piece, Pieces<T>& pieces) {
    if (pieces.empty() || pieces.back().capacity() - pieces.back().size() < list.size()) {
      pieces.emplace_back().reserve(std::max(list.size(), piece));
    }
    LargeArray<T>& last = pieces.back();
    last.insert(last.end(), list.begin(), list.end());
    return std::span<const T>(last).last(list.size());
  }

  std::size_t piece_ = kTermsOfAPoint;
  Pieces<std::uint32_t> components_;
  Pieces<Brdf> per_sds_;
  std::span<const std::uint32_t> last_components_;
};

}  // namespace gonio::calibration
