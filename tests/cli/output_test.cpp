#include "cli/output.h"

#include <gtest/gtest.h>

#include <sstream>

#include "cli/views.h"

namespace gonio::cli {
namespace {

TEST(Output, ColumnsLineUpAndNumbersStandToTheRight) {
  std::ostringstream out;

  print_table(out, {.header = {"scan", "state", "name"}, .rows = {{"3", "running", "wheat"}, {"12", "done", "a b"}}});

  EXPECT_EQ(out.str(), "scan  state    name\n   3  running  wheat\n  12  done     a b\n");
}

TEST(Output, CsvQuotesWhatNeedsIt) {
  std::ostringstream out;

  print_csv(out, {.header = {"a", "b"}, .rows = {{"x,y", "say \"no\""}, {"plain", "two\nlines"}}});

  EXPECT_EQ(out.str(), "a,b\n\"x,y\",\"say \"\"no\"\"\"\nplain,\"two\nlines\"\n");
}

TEST(Output, DurationsReadAsPeopleSayThem) {
  EXPECT_EQ(duration_text(4.21), "4.2 s");
  EXPECT_EQ(duration_text(65.4), "1 min 5 s");
  EXPECT_EQ(duration_text(3599.7), "60 min 0 s");
  EXPECT_EQ(duration_text(4320.0), "1 h 12 min");
}

TEST(Output, ProgressTellsShareStateTimeAndHolds) {
  api::ScanReport scan{.id = 3, .name = "wheat", .state = "running", .items = 200, .accepted = 49, .skipped = 1};
  scan.remaining_s = 65.0;
  scan.u_remaining_s = 4.0;
  EXPECT_EQ(progress_text(scan), "scan 3 wheat: 50 of 200 items, 25.0 %, running, 1 min 5 s to go (+- 4.0 s)");

  api::ScanReport held{.id = 3, .name = "wheat", .state = "holding", .items = 200, .accepted = 49};
  held.holds = {{.name = "lamp", .owner = "monitor", .reason = "0.1 is below 0.2"}};
  EXPECT_EQ(progress_text(held), "scan 3 wheat: 49 of 200 items, 24.5 %, holding: lamp (monitor: 0.1 is below 0.2)");
}

}  // namespace
}  // namespace gonio::cli
