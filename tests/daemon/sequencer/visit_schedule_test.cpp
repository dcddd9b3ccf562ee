#include "daemon/sequencer/visit_schedule.h"

#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

using std::chrono::seconds;

const Instant kNow{seconds(10'000)};

Detour far_away(NextJob /*visit*/) {
  return {.here = seconds(9), .least_ahead = seconds(1)};
}
Detour nowhere_nearer(NextJob /*visit*/) {
  return {.here = seconds(1), .least_ahead = seconds(1)};
}

// All visits wanted every 100 s, and made `ago` seconds before now.
VisitClocks visited(int ago) {
  const VisitClock clock{.every = seconds(100), .last = kNow - seconds(ago), .is_owed = ago > 0};
  return {.dark = clock, .reference = clock, .check = clock};
}

TEST(VisitSchedule, ARunBeginsWithADarkThenTheStandardThenTheSample) {
  VisitClocks clocks = visited(0);
  clocks.dark.last.reset();
  clocks.reference.last.reset();
  clocks.check.last.reset();

  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Dark);
  clocks.dark.last = kNow;
  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Reference);
  clocks.reference.last = kNow;
  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Check);
  clocks.check.last = kNow;
  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Item);
}

TEST(VisitSchedule, WhatThePlanDoesNotWantIsNotVisited) {
  VisitClocks clocks;
  clocks.dark = {.last = kNow - seconds(100'000), .is_owed = true};
  clocks.reference.is_owed = true;
  clocks.check.is_owed = true;

  EXPECT_EQ(next_job(clocks, kNow, true, nowhere_nearer), NextJob::Item);
  EXPECT_EQ(next_job(clocks, kNow, false, nowhere_nearer), NextJob::Nothing);
}

TEST(VisitSchedule, ADarkIsMadeWhenItIsDue) {
  VisitClocks clocks = visited(0);

  clocks.dark.last = kNow - seconds(99);
  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Item);
  clocks.dark.last = kNow - seconds(100);
  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Dark);
}

TEST(VisitSchedule, AVisitWaitsForItsNearestBoundaryWithinItsSlack) {
  VisitClocks clocks = visited(0);

  clocks.reference.last = kNow - seconds(79);
  EXPECT_EQ(next_job(clocks, kNow, true, nowhere_nearer), NextJob::Item) << "too early, however near";
  clocks.reference.last = kNow - seconds(80);
  EXPECT_EQ(next_job(clocks, kNow, true, nowhere_nearer), NextJob::Reference) << "nearer than it will be again";
  clocks.reference.last = kNow - seconds(119);
  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Item) << "a nearer boundary is still to come";
  clocks.reference.last = kNow - seconds(120);
  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Reference) << "no later than this, however far";
}

TEST(VisitSchedule, ACheckStandsBesideAReferenceVisit) {
  VisitClocks clocks = visited(0);
  clocks.check.last = kNow - seconds(120);
  clocks.reference.last = kNow - seconds(10);
  clocks.reference.is_owed = true;

  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Reference);
  clocks.reference = {.every = seconds(100), .last = kNow};
  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Check);
}

TEST(VisitSchedule, ACheckAloneNeedsNoReferenceVisit) {
  VisitClocks clocks = visited(0);
  clocks.reference = {};
  clocks.check.last = kNow - seconds(120);

  EXPECT_EQ(next_job(clocks, kNow, true, far_away), NextJob::Check);
}

TEST(VisitSchedule, TheLastItemsAreClosedByWhatIsOwed) {
  VisitClocks clocks = visited(10);

  EXPECT_EQ(next_job(clocks, kNow, false, far_away), NextJob::Reference);
  clocks.reference = visited(0).reference;
  EXPECT_EQ(next_job(clocks, kNow, false, far_away), NextJob::Check);
  clocks.check = visited(0).check;
  EXPECT_EQ(next_job(clocks, kNow, false, far_away), NextJob::Nothing);
  EXPECT_EQ(next_closing_job(clocks), NextJob::Dark);
  clocks.dark.is_owed = false;
  EXPECT_EQ(next_closing_job(clocks), NextJob::Nothing);
}

TEST(VisitSchedule, AFinishAfterARestartTakesADarkBeforeItVisits) {
  VisitClocks clocks = visited(10);
  clocks.dark.last.reset();

  EXPECT_EQ(next_closing_job(clocks), NextJob::Dark);
  clocks.dark.last = kNow;
  EXPECT_EQ(next_closing_job(clocks), NextJob::Reference);
}

}  // namespace
}  // namespace gonio::daemon
