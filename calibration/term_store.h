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
/// million points would cost two million allocations. What it keeps stays where it is, also when the store is moved.
/// Threads: one.
class TermStore {
 public:
  TermStore() = default;
  /// With room for about so many points.
  explicit TermStore(std::size_t points) : piece_(points * kTermsOfAPoint) {}
  TermStore(TermStore&&) = default;
  TermStore& operator=(TermStore&&) = default;

  [[nodiscard]] std::span<const BudgetTerm> keep(std::span<const BudgetTerm> terms) {
    if (pieces_.empty() || pieces_.back().capacity() - pieces_.back().size() < terms.size()) {
      pieces_.emplace_back().reserve(std::max(terms.size(), piece_));
    }
    LargeArray<BudgetTerm>& piece = pieces_.back();
    piece.insert(piece.end(), terms.begin(), terms.end());
    return std::span<const BudgetTerm>(piece).last(terms.size());
  }

  /// Component n of every list becomes numbers[n].
  void renumber(std::span<const std::uint32_t> numbers) {
    for (LargeArray<BudgetTerm>& piece : pieces_) {
      for (BudgetTerm& term : piece) term.component = numbers[term.component];
    }
  }

 private:
  static constexpr std::size_t kTermsOfAPoint = 32;

  std::size_t piece_ = kTermsOfAPoint;
  std::vector<LargeArray<BudgetTerm>> pieces_;
};

}  // namespace gonio::calibration
