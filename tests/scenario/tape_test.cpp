// A night that was recorded is replayed without devices, to the same store; what is not as it was is named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

using testing::HasSubstr;

const PlanOptions kPlan{.theta_i_deg = "[10, 40]", .theta_r_deg = "[0, 30]", .phi_r_deg = "[180]"};

class Tape : public testing::Test {
 protected:
  explicit Tape(const SceneOptions& scene = {}) : bench_(scene) {}

  // Starts a daemon that records; a store of its own, if it is the first.
  void record(const std::string& tape) {
    bench_.record_to(bench_.folder() + "/" + tape);
    bench_.bring_up_daemon();
  }
  long measure() {
    const long scan = bench_.submit(plan_text(kPlan));
    EXPECT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted"}), "done") << bench_.log();
    return scan;
  }
  // Waits until the BRDF that follows a scan is stored too.
  void wait_for_brdf() {
    const auto is_stored = [&] { return count_of(all_events(bench_, bench_.daemon().port()), "brdf-computed") > 0; };
    EXPECT_TRUE(eventually(is_stored, kStepDeadline)) << bench_.log();
  }
  // Without the simulator: nothing would answer.
  Finished replay(const std::string& tape, const std::vector<std::string>& more = {},
                  const std::string& store = "replayed.sqlite") const {
    std::vector<std::string> line{kGonioctl, "replay", bench_.folder() + "/" + tape, "--store",
                                  bench_.folder() + "/" + store};
    line.insert(line.end(), more.begin(), more.end());
    return run_program(line, bench_.folder(), kScanDeadline);
  }
  std::vector<std::string> against_the_store() const { return {"--against", bench_.files().store}; }

  Bench bench_;
};

TEST_F(Tape, ReplaysARecordedScanToTheSameStoreAlways) {
  record("night.tape");
  measure();
  wait_for_brdf();
  ASSERT_EQ(bench_.end_daemon(), 0) << text_of(bench_.folder() + "/goniod.log");

  const Finished once = replay("night.tape", against_the_store());
  const Finished twice = replay("night.tape", {"--against", bench_.folder() + "/replayed.sqlite"}, "again.sqlite");

  EXPECT_EQ(once.exit_code, 0) << once.output << once.errors;
  EXPECT_THAT(once.output, HasSubstr("8 items accepted"));
  EXPECT_THAT(once.output, HasSubstr("the tape: ended"));
  EXPECT_THAT(once.output, HasSubstr("the store is that of"));
  EXPECT_EQ(twice.exit_code, 0) << twice.output << twice.errors;
  EXPECT_THAT(twice.output, HasSubstr(" 0 measured times differ"));
  std::cout << once.output;
}

TEST_F(Tape, CatchesADriverThatSendsAnotherRequest) {
  record("night.tape");
  measure();
  ASSERT_EQ(bench_.end_daemon(), 0) << text_of(bench_.folder() + "/goniod.log");
  // Twice the degrees a count: every target is half as many counts.
  std::string changed = text_of(bench_.files().instrument);
  const std::size_t axis = changed.find("[stage.registers.axes.theta_i]");
  ASSERT_NE(axis, std::string::npos) << changed;
  const std::size_t scale = changed.find("scale = 0.0001", axis);
  ASSERT_NE(scale, std::string::npos) << changed;
  changed.replace(scale, 14, "scale = 0.0002");

  const Finished replayed = replay("night.tape", {"--instrument", bench_.file("changed.toml", changed)});

  EXPECT_EQ(replayed.exit_code, 1) << replayed.output << replayed.errors;
  EXPECT_THAT(replayed.errors, HasSubstr("replay record "));
  EXPECT_THAT(replayed.errors, HasSubstr("asked now: write "));
  EXPECT_THAT(replayed.errors, HasSubstr("then: write "));
}

TEST_F(Tape, ReplaysAStopAndWhatFollowsIt) {
  record("night.tape");
  const long scan = bench_.submit(plan_text(kPlan));
  EventReader events(bench_.daemon().port(), 0);
  ASSERT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") > 0; }, kStepDeadline));
  ASSERT_EQ(bench_.gonioctl({"stop"}).exit_code, 0);
  ASSERT_EQ(bench_.wait_for_state(scan, {"holding", "done"}), "holding");
  bench_.reset_and_resume(scan);
  ASSERT_EQ(bench_.wait_for_state(scan, {"done", "failed"}), "done") << bench_.log();
  wait_for_brdf();
  ASSERT_EQ(bench_.end_daemon(), 0) << text_of(bench_.folder() + "/goniod.log");

  const Finished replayed = replay("night.tape", against_the_store());

  EXPECT_EQ(replayed.exit_code, 0) << replayed.output << replayed.errors;
}

TEST_F(Tape, ReplaysFaultsThatWereMetAndRetried) {
  record("night.tape");
  const long scan = bench_.submit(plan_text(kPlan));
  EventReader events(bench_.daemon().port(), 0);
  ASSERT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") > 0; }, kStepDeadline));
  bench_.simulator().refuse_stage(true);
  ASSERT_TRUE(eventually([&] { return !bench_.get("status").at("stage_error").is_null(); }, kStepDeadline));
  bench_.simulator().refuse_stage(false);
  if (bench_.wait_for_state(scan, {"holding", "done", "failed"}) == "holding") bench_.reset_and_resume(scan);
  ASSERT_EQ(bench_.wait_for_state(scan, {"done", "failed"}), "done") << bench_.log();
  wait_for_brdf();
  ASSERT_EQ(bench_.end_daemon(), 0) << text_of(bench_.folder() + "/goniod.log");

  const Finished replayed = replay("night.tape", against_the_store());

  EXPECT_EQ(replayed.exit_code, 0) << replayed.output << replayed.errors;
}

TEST_F(Tape, ReplaysAKilledDaemonAndTheOneAfterItOnOneStore) {
  record("first.tape");
  const long scan = bench_.submit(plan_text(kPlan));
  EventReader events(bench_.daemon().port(), 0);
  ASSERT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") > 1; }, kStepDeadline));
  bench_.daemon().kill();
  std::filesystem::copy_file(bench_.files().store, bench_.folder() + "/killed.sqlite");
  if (std::filesystem::exists(bench_.files().store + "-wal")) {
    std::filesystem::copy_file(bench_.files().store + "-wal", bench_.folder() + "/killed.sqlite-wal");
  }
  record("second.tape");
  ASSERT_EQ(bench_.wait_for_state(scan, {"done", "failed"}), "done") << bench_.log();
  wait_for_brdf();
  ASSERT_EQ(bench_.end_daemon(), 0) << text_of(bench_.folder() + "/goniod.log");

  const Finished first = replay("first.tape");
  const Finished wrong = replay("second.tape", {}, "empty.sqlite");
  const Finished second = replay("second.tape", against_the_store(), "killed.sqlite");

  EXPECT_EQ(first.exit_code, 0) << first.output << first.errors;
  EXPECT_THAT(first.output, HasSubstr("cut off"));
  EXPECT_NE(wrong.exit_code, 0);
  EXPECT_THAT(wrong.errors, HasSubstr("replay what came before it first"));
  EXPECT_EQ(second.exit_code, 0) << second.output << second.errors;
}

std::string meter(const std::string& role, const std::string& serial) {
  return "[[radiometers]]\nrole = \"" + role + "\"\nserial = \"" + serial +
         "\"\nranges_w = [1e-5, 1e-4, 1e-3, 1e-2]\naverage_s = 0.04\nzero_s = 1.0\nnoise = 1e-4\n";
}

/// A radiometer before the sample and one before the lamp, or the latter beside a camera.
class TapeOfRadiometers : public Tape, public testing::WithParamInterface<const char*> {
 protected:
  TapeOfRadiometers() : Tape({.more = meters()}) {}
  static std::string meters() {
    const std::string both = meter("detector", "SIM-PM-01") + meter("monitor", "SIM-PM-02");
    return std::string(GetParam()) == "Detector" ? both : meter("monitor", "SIM-PM-02");
  }
};

TEST_P(TapeOfRadiometers, IsReplayedToTheSameStoreAndCatchesAChangedRequest) {
  record("night.tape");
  const Finished read = bench_.gonioctl({"detector", "read", "--dark", "-o", "json"});
  EXPECT_EQ(read.exit_code, 0) << read.output << read.errors;
  measure();
  wait_for_brdf();
  ASSERT_EQ(bench_.end_daemon(), 0) << text_of(bench_.folder() + "/goniod.log");
  std::string changed = text_of(bench_.files().instrument);
  const std::size_t section = changed.find("[monitor]");
  const std::size_t wavelength = changed.find("wavelength_nm = 568", section);
  ASSERT_NE(wavelength, std::string::npos) << changed;
  changed.replace(wavelength, 19, "wavelength_nm = 569");

  const Finished once = replay("night.tape", against_the_store());
  const Finished other = replay("night.tape", {"--instrument", bench_.file("changed.toml", changed)}, "changed.sqlite");

  EXPECT_EQ(once.exit_code, 0) << once.output << once.errors;
  EXPECT_THAT(once.output, HasSubstr("8 items accepted"));
  EXPECT_THAT(once.output, HasSubstr("the store is that of"));
  EXPECT_EQ(other.exit_code, 1) << other.output << other.errors;
  EXPECT_THAT(other.errors, HasSubstr("replay record "));
  EXPECT_THAT(other.errors, HasSubstr("SENS:CORR:WAV 569"));
}

INSTANTIATE_TEST_SUITE_P(As, TapeOfRadiometers, testing::Values("Detector", "Monitor"),
                         [](const auto& role) { return std::string(role.param); });

}  // namespace
}  // namespace gonio::test
