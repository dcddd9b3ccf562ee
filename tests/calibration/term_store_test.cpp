#include "calibration/term_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace gonio::calibration {
namespace {

Budget kept(TermStore& store, std::vector<BudgetTerm> random, std::vector<BudgetTerm> shared) {
  const std::vector<Component> components(10);
  TermColumns columns;
  Budget budget = make_budget(components, random, shared, columns);
  store.keep(budget);
  return budget;
}

void expect_terms(const BudgetTerms& terms, const std::vector<BudgetTerm>& expected) {
  EXPECT_TRUE(std::ranges::equal(terms, expected));
}

TEST(TermStore, KeepsTermsWhereTheyAreWhenItIsMoved) {
  TermStore first(2);
  const Budget a = kept(first, {{0, per_steradian(1.0)}}, {{3, per_steradian(-2.0)}, {5, per_steradian(4.0)}});
  const Budget b = kept(first, {}, {{5, per_steradian(6.0)}});

  const TermStore moved = std::move(first);

  expect_terms(a.random, {{0, per_steradian(1.0)}});
  expect_terms(a.shared, {{3, per_steradian(-2.0)}, {5, per_steradian(4.0)}});
  EXPECT_TRUE(b.random.empty());
  expect_terms(b.shared, {{5, per_steradian(6.0)}});
}

TEST(TermStore, NamesTheComponentsOfPointsThatHaveTheSameOnce) {
  TermStore store(3);
  const Budget a = kept(store, {{1, per_steradian(1.0)}}, {{2, per_steradian(2.0)}});
  const Budget b = kept(store, {{1, per_steradian(3.0)}}, {{2, per_steradian(4.0)}});
  const Budget c = kept(store, {{1, per_steradian(5.0)}}, {{3, per_steradian(6.0)}});

  EXPECT_EQ(a.shared.components(), b.shared.components());
  EXPECT_NE(b.shared.components(), c.shared.components());
}

// As many random terms as the other has terms, of the same components: they are not told apart by the list alone.
TEST(TermStore, KnowsWhereTheRandomTermsEnd) {
  TermStore store(2);
  const Budget a = kept(store, {{1, per_steradian(1.0)}, {2, per_steradian(2.0)}}, {});
  const Budget b = kept(store, {{1, per_steradian(3.0)}}, {{2, per_steradian(4.0)}});

  expect_terms(a.random, {{1, per_steradian(1.0)}, {2, per_steradian(2.0)}});
  expect_terms(b.random, {{1, per_steradian(3.0)}});
  expect_terms(b.shared, {{2, per_steradian(4.0)}});
}

TEST(TermStore, RenumbersEachListOnce) {
  TermStore store(2);
  const Budget a = kept(store, {{1, per_steradian(1.0)}}, {{2, per_steradian(2.0)}});
  const Budget b = kept(store, {{1, per_steradian(3.0)}}, {{2, per_steradian(4.0)}});

  store.renumber(std::array<std::uint32_t, 3>{0, 2, 1});

  for (const Budget* budget : {&a, &b}) {
    EXPECT_EQ(budget->random[0].component, 2U);
    EXPECT_EQ(budget->shared[0].component, 1U);
  }
}

TEST(TermStore, TakesMoreThanWasExpected) {
  TermStore store(1);
  std::vector<Budget> budgets;
  for (std::uint32_t n = 0; n < 1000; ++n) {
    budgets.push_back(kept(store, {{n % 7, per_steradian(1.0 + n)}}, {{8, per_steradian(n + 0.5)}}));
  }

  for (std::uint32_t n = 0; n < 1000; ++n) {
    expect_terms(budgets[n].random, {{n % 7, per_steradian(1.0 + n)}});
    expect_terms(budgets[n].shared, {{8, per_steradian(n + 0.5)}});
  }
}

}  // namespace
}  // namespace gonio::calibration
