#include "daemon/sequencer/time_ledger.h"

#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;

const Instant kStart{100s};

TEST(TimeLedger, EachInstantGoesIntoOneAccount) {
  TimeLedger ledger;
  ledger.restart(kStart);
  Duration planning{};
  Duration move{};
  Duration settle{};
  Duration wire{};

  ledger.enter(planning, kStart + 2ms);
  ledger.enter_first(100ms, move, kStart + 152ms);
  ledger.enter(20ms, settle, wire, kStart + 152ms);

  EXPECT_EQ(planning, 2ms);
  EXPECT_EQ(move, 100ms);
  EXPECT_EQ(settle, 20ms);
  EXPECT_EQ(wire, 30ms);
}

TEST(TimeLedger, WhatWasQuickerThanItsModelTookWhatItTook) {
  TimeLedger ledger;
  ledger.restart(kStart);
  Duration move{};
  Duration settle{};
  Duration wire{};

  ledger.enter_first(100ms, move, kStart + 80ms);
  ledger.enter(20ms, settle, wire, kStart + 80ms);

  EXPECT_EQ(move, 80ms);
  EXPECT_EQ(settle, 0ms);
  EXPECT_EQ(wire, 0ms);
}

TEST(TimeLedger, AnEntryOfThePastCountsNothing) {
  TimeLedger ledger;
  ledger.restart(kStart);
  Duration account{};

  ledger.enter(account, kStart - 1s);
  ledger.enter(account, kStart + 1s);

  EXPECT_EQ(account, 1s);
}

}  // namespace
}  // namespace gonio::daemon
