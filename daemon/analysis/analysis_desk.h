#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "protocol/api/analysis.h"

namespace gonio::daemon {

struct AnalysisDeskOptions {
  std::string program;  ///< gonio-analyse
  std::string store_file;
  std::string folder;  ///< emptied at the start; each job has a folder in it
  std::size_t most_waiting = 32;
  std::size_t most_kept = 64;  ///< jobs that are over, with their files; the oldest go first
};

/// The jobs of the worker program: one at a time, in their order, each within its deadline. Nothing of a job is in the
/// store. The destructor ends the job in hand. Threads: any.
class AnalysisDesk {
 public:
  /// `clock` must outlive the desk.
  AnalysisDesk(AnalysisDeskOptions options, const Clock& clock);
  ~AnalysisDesk();
  AnalysisDesk(const AnalysisDesk&) = delete;
  AnalysisDesk& operator=(const AnalysisDesk&) = delete;

  /// Errors: InvalidInput (a kind, format or deadline that there is not), Busy.
  [[nodiscard]] Result<api::AnalysisReport> start(const api::AnalysisRequest& request, const std::string& who);
  [[nodiscard]] api::AnalysisList all() const;
  /// Errors: NotFound.
  [[nodiscard]] Result<api::AnalysisReport> one(std::int64_t job) const;
  /// The bytes of a file that the job's report names. Errors: NotFound, WrongState, FileUnreadable.
  [[nodiscard]] Result<std::string> file(std::int64_t job, const std::string& name) const;
  /// One that is over stays as it is. Errors: NotFound.
  [[nodiscard]] Result<api::AnalysisReport> cancel(std::int64_t job);

 private:
  struct Job {
    api::AnalysisRequest request;
    api::AnalysisReport report;
    std::atomic<bool> cancelled{false};
  };

  void work();
  void run(const std::shared_ptr<Job>& job);
  [[nodiscard]] Result<std::vector<std::string>> command_of(const Job& job) const;
  /// How it ended, or why it did not.
  [[nodiscard]] Result<api::AnalysisReport> ask_worker(Job& job);
  void finish(Job& job, const Result<api::AnalysisReport>& outcome);
  void forget_old_ones();
  [[nodiscard]] std::string folder_of(std::int64_t job) const;

  const AnalysisDeskOptions options_;
  const Clock& clock_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::int64_t last_ = 0;
  std::map<std::int64_t, std::shared_ptr<Job>> jobs_;
  std::deque<std::shared_ptr<Job>> waiting_;
  std::shared_ptr<Job> in_hand_;
  std::thread thread_;
};

}  // namespace gonio::daemon
