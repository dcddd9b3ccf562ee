#include "daemon/sequencer/scan_items.h"

#include <gtest/gtest.h>

#include <numeric>

namespace gonio::daemon {
namespace {

using calibration::Target;
using std::chrono::seconds;

const Instant kStart{seconds(1000)};

// Accepts `count` items, one every `apart`; what they were.
std::vector<ItemKey> take(ScanItems& items, int count, Duration apart = seconds(1), Instant from = kStart) {
  std::vector<ItemKey> taken;
  for (int k = 0; k < count; ++k) {
    const auto next = items.next(from + k * apart);
    if (!next) break;
    items.accept(*next, from + k * apart);
    taken.push_back(*next);
  }
  return taken;
}

TEST(ScanItems, ABlockOfSamplesIsFollowedByItsReferencesLastFirst) {
  ScanItems items(3, {2, 0, 1}, seconds(100), {}, {});

  const auto taken = take(items, 99);

  EXPECT_EQ(taken, (std::vector<ItemKey>{{2, Target::Sample},
                                         {0, Target::Sample},
                                         {1, Target::Sample},
                                         {1, Target::Reference},
                                         {0, Target::Reference},
                                         {2, Target::Reference}}));
  EXPECT_EQ(items.accepted(), 6);
}

TEST(ScanItems, WithoutPartnersAreTheSamplesAloneInTheirOrder) {
  for (const auto mode : {api::ReferenceMode::Anchor, api::ReferenceMode::Absolute}) {
    ScanItems items(3, {2, 0, 1}, seconds(1), {}, {}, mode);
    EXPECT_EQ(items.next_after({2, Target::Sample}, kStart), (ItemKey{0, Target::Sample}));

    const auto taken = take(items, 99);

    EXPECT_EQ(taken, (std::vector<ItemKey>{{2, Target::Sample}, {0, Target::Sample}, {1, Target::Sample}}));
    EXPECT_EQ(items.total(), 3);
    EXPECT_EQ(items.accepted(), 3);
    EXPECT_EQ(items.open(Target::Reference), 0);
    EXPECT_FALSE(items.owes_reference());
  }
}

TEST(ScanItems, WithoutPartnersARestartAReopeningAndAnotherOrderTakeTheSampleAlone) {
  ScanItems items(3, {2, 0, 1}, seconds(100), {{2, Target::Sample}}, {}, api::ReferenceMode::Anchor);

  EXPECT_FALSE(items.is_on_reference());
  EXPECT_EQ(items.untouched(), (std::vector<std::int32_t>{0, 1}));
  items.reorder({1, 0});
  EXPECT_EQ(items.next(kStart), (ItemKey{1, Target::Sample}));
  EXPECT_EQ(items.reopen(2), (std::vector<ItemKey>{{2, Target::Sample}}));
  EXPECT_EQ(items.give_up({1, Target::Sample}), (std::vector<ItemKey>{{1, Target::Sample}}));
  EXPECT_EQ(items.next(kStart), (ItemKey{2, Target::Sample}));
}

TEST(ScanItems, WhatIsNextAfterAnItemIsKnownBeforeItIsAccepted) {
  std::vector<std::int32_t> order(40);
  std::iota(order.begin(), order.end(), 0);
  ScanItems items(40, order, seconds(21), {{3, Target::Sample}, {7, Target::Sample}, {7, Target::Reference}}, {});

  Instant now = kStart;
  for (auto item = items.next(now); item; item = items.next(now)) {
    const auto foreseen = items.next_after(*item, now);
    items.accept(*item, now);
    EXPECT_EQ(foreseen, items.next(now)) << "after point " << item->point;
    now += seconds(1);
  }
  EXPECT_EQ(items.accepted(), 80);
}

TEST(ScanItems, TakenAsForeseenTheyMakeTheSameBlocks) {
  std::vector<std::int32_t> order(40);
  std::iota(order.begin(), order.end(), 0);
  ScanItems asked(40, order, seconds(21), {}, {});
  ScanItems foreseen(40, order, seconds(21), {}, {});

  Instant now = kStart;
  auto item = foreseen.next(now);
  for (; item; now += seconds(1)) {
    ASSERT_EQ(item, asked.next(now));
    asked.accept(*item, now);
    const auto next = foreseen.next_after(*item, now + seconds(1));
    foreseen.accept(*item, now);
    item = next;
  }
  EXPECT_EQ(foreseen.accepted(), 80);
}

TEST(ScanItems, PartnersLieWithinTheBlocksTime) {
  std::vector<std::int32_t> order(40);
  for (int k = 0; k < 40; ++k) order[static_cast<std::size_t>(k)] = k;
  ScanItems items(40, order, seconds(20), {}, {});
  std::vector<Instant> sample_at(40);
  Duration longest{};

  for (int k = 0; k < 80; ++k) {
    const Instant now = kStart + k * seconds(1);
    const auto next = items.next(now);
    ASSERT_TRUE(next);
    items.accept(*next, now);
    const auto p = static_cast<std::size_t>(next->point);
    if (next->target == Target::Sample) sample_at[p] = now;
    if (next->target == Target::Reference) longest = std::max(longest, now - sample_at[p]);
  }

  EXPECT_LE(longest, seconds(20));
  EXPECT_FALSE(items.next(kStart + seconds(80)));
}

TEST(ScanItems, ARestartClosesTheOpenBlockAndGoesOnWithTheNextUnmeasured) {
  ScanItems items(4, {0, 1, 2, 3}, seconds(100), {{0, Target::Sample}, {1, Target::Sample}, {1, Target::Reference}},
                  {});

  const auto taken = take(items, 2);

  EXPECT_EQ(taken, (std::vector<ItemKey>{{0, Target::Reference}, {2, Target::Sample}}));
}

TEST(ScanItems, SkippingASampleSkipsItsPartner) {
  ScanItems items(2, {0, 1}, seconds(100), {}, {});

  const auto gone = items.give_up({0, Target::Sample});

  EXPECT_EQ(gone, (std::vector<ItemKey>{{0, Target::Sample}, {0, Target::Reference}}));
  EXPECT_EQ(take(items, 9).size(), 2U);
  EXPECT_EQ(items.skipped(), 2);
  EXPECT_EQ(items.open(Target::Sample), 0);
}

TEST(ScanItems, SkippingAReferenceSkipsItAlone) {
  ScanItems items(1, {0}, seconds(100), {{0, Target::Sample}}, {});

  EXPECT_EQ(items.give_up({0, Target::Reference}).size(), 1U);
  EXPECT_FALSE(items.next(kStart));
}

}  // namespace
}  // namespace gonio::daemon
