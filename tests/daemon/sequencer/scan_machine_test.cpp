#include "daemon/sequencer/scan_machine.h"

#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

TEST(ScanMachine, EveryPairNotInTheTableIsRefusedNamingEventStateAndTheStatesThatAllowIt) {
  int allowed = 0;
  for (const ScanState state : kAllScanStates) {
    for (const ScanEvent event : kAllScanEvents) {
      if (next_state(state, event)) {
        ++allowed;
        continue;
      }
      const Error error = wrong_state(12, state, event);
      EXPECT_EQ(error.code, ErrorCode::WrongState);
      EXPECT_NE(error.tried.find(scan_event_name(event)), std::string::npos);
      EXPECT_NE(error.tried.find("12"), std::string::npos);
      EXPECT_NE(error.seen.find(scan_state_name(state)), std::string::npos);
      EXPECT_FALSE(error.limit.empty());
    }
  }
  EXPECT_EQ(allowed, static_cast<int>(kScanSteps.size()));
}

TEST(ScanMachine, NothingLeavesAnEnd) {
  for (const ScanState state : kAllScanStates) {
    if (!is_over(state)) continue;
    for (const ScanEvent event : kAllScanEvents) EXPECT_FALSE(next_state(state, event)) << scan_state_name(state);
  }
}

TEST(ScanMachine, EveryScanThatIsNotOverCanBeAborted) {
  for (const ScanState state : kAllScanStates) {
    if (is_over(state)) continue;
    EXPECT_EQ(next_state(state, ScanEvent::Abort), ScanState::Aborted) << scan_state_name(state);
  }
}

TEST(ScanMachine, WhatIsUnderWayIsInterruptedWhenFoundAtStartUp) {
  for (const ScanState state : {ScanState::Preparing, ScanState::Running, ScanState::Holding, ScanState::Finishing}) {
    EXPECT_EQ(next_state(state, ScanEvent::Found), ScanState::Interrupted);
  }
}

}  // namespace
}  // namespace gonio::daemon
