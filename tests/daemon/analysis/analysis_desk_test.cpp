// The desk with programs of the test's own making in place of gonio-analyse: shell scripts that do what a worker might.
#include "daemon/analysis/analysis_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "tests/support/process.h"

namespace gonio::daemon {
namespace {

using gonio::test::eventually;
using testing::HasSubstr;

constexpr std::chrono::seconds kLong{60};  // a bound against hanging, never a speed to be met

class Desk : public testing::Test {
 protected:
  // $INTO is the job's folder.
  void work_with(const std::string& script, std::size_t most_waiting = 32, std::size_t most_kept = 64) {
    const std::string program = folder_ / "worker";
    gonio::test::write_text(
        program, "#!/bin/sh\nwhile [ $# -gt 0 ]; do [ \"$1\" = --into ] && INTO=$2; shift; done\n" + script + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    desk_ = std::make_unique<AnalysisDesk>(AnalysisDeskOptions{.program = program,
                                                               .store_file = folder_ / "store",
                                                               .folder = folder_ / "jobs",
                                                               .most_waiting = most_waiting,
                                                               .most_kept = most_kept},
                                           clock_);
  }
  static api::AnalysisRequest report_of(std::int64_t scan) { return {.kind = "report", .scan = scan}; }
  std::int64_t start(const api::AnalysisRequest& request = report_of(3)) {
    const auto started = desk_->start(request, "uid:7");
    EXPECT_TRUE(started) << describe(started.error());
    return started ? started->id : 0;
  }
  api::AnalysisReport wait_for_end(std::int64_t job) {
    EXPECT_TRUE(eventually([&] { return !desk_->one(job)->ended_utc.empty(); }, kLong));
    return *desk_->one(job);
  }
  bool is_running(std::int64_t job) {
    return eventually([&] { return desk_->one(job)->state == "running"; }, kLong);
  }

  gonio::test::TemporaryFolder folder_;
  SystemClock clock_;
  std::unique_ptr<AnalysisDesk> desk_;
};

TEST_F(Desk, TellsProgressAndHandsOutTheFilesOfAJob) {
  work_with(R"(mkfifo "$INTO/../../go"
echo '{"state": "running", "progress": 0.5, "doing": "drawing"}'
read x < "$INTO/../../go"
printf hello > "$INTO/a.txt"
echo '{"state": "done", "files": [{"name": "a.txt", "bytes": 5}], "losses": [{"kind": "sign", "values": 2, "what": "w"}]}')");
  const std::int64_t job = start();

  EXPECT_TRUE(eventually([&] { return desk_->one(job)->doing == "drawing"; }, kLong));
  EXPECT_EQ(desk_->one(job)->progress, 0.5);
  EXPECT_FALSE(desk_->file(job, "a.txt")) << "not before it is done";
  gonio::test::write_text(folder_ / "go", "on\n");
  const api::AnalysisReport done = wait_for_end(job);

  EXPECT_EQ(done.state, "done");
  EXPECT_EQ(done.who, "uid:7");
  EXPECT_EQ(done.losses.at(0).kind, "sign");
  EXPECT_EQ(desk_->file(job, "a.txt").value(), "hello");
  EXPECT_EQ(desk_->file(job, "../worker").error().code, ErrorCode::NotFound) << "only what the job names";
}

TEST_F(Desk, SaysWithAWordThatAWorkerWasKilled) {
  work_with("echo '{\"state\": \"running\", \"doing\": \"integrating\"}'\ntouch \"$INTO/half\"\nkill -9 $$");
  const std::int64_t job = start();

  const api::AnalysisReport failed = wait_for_end(job);

  EXPECT_EQ(failed.state, "failed");
  ASSERT_TRUE(failed.error);
  EXPECT_EQ(failed.error->tried, "integrating");
  EXPECT_THAT(failed.error->seen, HasSubstr("signal 9"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "jobs/1/half")) << "what it left is gone";
  EXPECT_EQ(wait_for_end(start()).state, "failed") << "the next one is taken all the same";
}

TEST_F(Desk, PassesOnWhatAWorkerSaidLast) {
  work_with("echo 'cannot find libm' >&2; exit 127");

  const api::AnalysisReport failed = wait_for_end(start());

  EXPECT_THAT(failed.error->seen, HasSubstr("exit code 127, saying: cannot find libm"));
}

TEST_F(Desk, EndsAJobAtItsDeadline) {
  work_with("exec tail -f /dev/null");
  api::AnalysisRequest request = report_of(3);
  request.deadline_s = 0.05;

  const api::AnalysisReport late = wait_for_end(start(request));

  EXPECT_EQ(late.state, "failed");
  EXPECT_EQ(late.error->code, ErrorCode::TimedOut);
}

TEST_F(Desk, CancelsTheJobInHandAndTheOnesThatWait) {
  work_with("exec tail -f /dev/null");
  const std::int64_t first = start();
  const std::int64_t second = start();
  ASSERT_TRUE(is_running(first));

  EXPECT_EQ(desk_->cancel(second)->state, "cancelled");
  EXPECT_TRUE(desk_->cancel(first));

  EXPECT_EQ(wait_for_end(first).state, "cancelled");
  EXPECT_EQ(desk_->cancel(77).error().code, ErrorCode::NotFound);
}

TEST_F(Desk, TakesNoMoreThanMayWait) {
  work_with("exec tail -f /dev/null", 1);
  ASSERT_TRUE(is_running(start()));
  start();

  EXPECT_EQ(desk_->start(report_of(3), "").error().code, ErrorCode::Busy);
}

TEST_F(Desk, ForgetsTheOldestJobsThatAreOver) {
  work_with("echo '{\"state\": \"done\"}'", 32, 2);
  for (int i = 0; i < 4; ++i) wait_for_end(start());

  const api::AnalysisList list = desk_->all();

  ASSERT_EQ(list.jobs.size(), 2U);
  EXPECT_EQ(list.jobs[0].id, 4);
  EXPECT_EQ(list.jobs[1].id, 3);
}

TEST_F(Desk, RefusesWhatThereIsNot) {
  work_with("exit 0");
  const auto code = [&](const api::AnalysisRequest& request) { return desk_->start(request, "").error().where->field; };

  EXPECT_EQ(code({.kind = "dance", .scan = 3}), "kind");
  EXPECT_EQ(code({.kind = "export", .scan = 3, .format = "exr"}), "format");
  EXPECT_EQ(code({.kind = "trace", .scan = 3}), "point");
  EXPECT_EQ(code({.kind = "report"}), "scan");
  EXPECT_EQ(code({.kind = "report", .scan = 3, .deadline_s = 1e9}), "deadline_s");
}

TEST_F(Desk, NamesAProgramThatIsNotThere) {
  desk_ = std::make_unique<AnalysisDesk>(
      AnalysisDeskOptions{.program = folder_ / "none", .store_file = "s", .folder = folder_ / "jobs"}, clock_);

  const api::AnalysisReport failed = wait_for_end(start());

  EXPECT_EQ(failed.error->code, ErrorCode::FileUnreadable);
  EXPECT_EQ(failed.error->where->file, folder_ / "none");
}

TEST_F(Desk, EndsTheJobInHandWithItself) {
  work_with("echo $$ > \"$INTO/../pid\"; exec tail -f /dev/null");
  start();
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "jobs/pid"); }, kLong));

  desk_.reset();

  EXPECT_FALSE(std::filesystem::exists(folder_ / "jobs"));
}

}  // namespace
}  // namespace gonio::daemon
