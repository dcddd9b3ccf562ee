// gonioctl doctor on the simulated instrument: all well, then with something wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

using testing::HasSubstr;
using testing::Not;

bool shows_an_open_interlock(const Bench& bench) {
  const auto deadline = std::chrono::steady_clock::now() + kStepDeadline;
  while (std::chrono::steady_clock::now() < deadline) {
    try {
      if (bench.get("stage").at("interlock_open")) return true;
    } catch (const std::runtime_error&) {
      continue;  // a daemon that is ready may not have heard its stage yet
    }
  }
  return false;
}

TEST(DoctorScenario, FindsNothingWrongWithAGoodInstrumentAndStopsItOnce) {
  Bench bench(SceneOptions{.time_scale = 10.0});
  bench.bring_up_daemon();

  const Finished well = bench.gonioctl({"doctor", "--move"});

  EXPECT_EQ(well.exit_code, 0) << well.output << bench.log();
  EXPECT_THAT(well.output, Not(HasSubstr("FAILED")));
  for (const char* axis : {"theta_i", "theta_r", "phi_r", "phi_i", "carriage", "filter_wheel"}) {
    EXPECT_THAT(well.output, testing::ContainsRegex(std::string("(ok|warning) +axis ") + axis + " moves"))
        << well.output;
  }
  EXPECT_THAT(well.output, testing::ContainsRegex("ok +detector reads in the dark")) << well.output;
  EXPECT_THAT(well.output, testing::ContainsRegex("(ok|warning) +detector sees the lamp")) << well.output;
  EXPECT_THAT(well.output, HasSubstr("STOP halts a move"));
  EXPECT_FALSE(bench.get("stage").at("halted")) << "it cleared its own STOP";
}

TEST(DoctorScenario, NamesAnOpenInterlockAndMovesNothing) {
  Bench bench(SceneOptions{});
  bench.bring_up_daemon();
  bench.simulator().open_interlock(true);
  ASSERT_TRUE(shows_an_open_interlock(bench)) << "the daemon looks at the stage once a second";

  const Finished finished = bench.gonioctl({"doctor", "--move"});

  EXPECT_EQ(finished.exit_code, 1) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("the interlock is open"));
  EXPECT_THAT(finished.output, HasSubstr("skipped  motion: the stage is not free to move"));
}

}  // namespace
}  // namespace gonio::test
