#include "daemon/analysis/analysis_desk.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "base/write_file.h"
#include "daemon/analysis/worker_process.h"
#include "protocol/api/base64.h"
#include "protocol/api/json.h"

namespace gonio::daemon {
namespace {

constexpr double kLongestDeadline = 3600.0;

template <class Names>
std::string joined(const Names& names) {
  std::string text;
  for (const std::string_view name : names) text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

Error bad_request(std::string field, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .device = "analysis",
          .tried = "queue a job",
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{"", 0, std::move(field)}};
}

Result<void> check(const api::AnalysisRequest& request) {
  if (std::ranges::find(api::kAnalysisKinds, request.kind) == api::kAnalysisKinds.end()) {
    return failure(bad_request("kind", "\"" + request.kind + "\"", joined(api::kAnalysisKinds)));
  }
  const bool needs_format = request.kind == "export";
  if (needs_format && std::ranges::find(api::kExportFormats, request.format) == api::kExportFormats.end()) {
    return failure(bad_request("format", "\"" + request.format + "\"", joined(api::kExportFormats)));
  }
  if (request.kind == "trace" && !request.point) return failure(bad_request("point", "none", "a point's number"));
  if (request.kind == "compare") {
    const int others =
        (request.other_scan > 0 ? 1 : 0) + (request.other_model.empty() ? 0 : 1) + (request.other_file.empty() ? 0 : 1);
    if (others != 1) {
      return failure(bad_request("other_scan", fmt::format("{} things to compare with", others),
                                 "one of other_scan, other_model, other_file"));
    }
  }
  if (request.scan <= 0) return failure(bad_request("scan", std::to_string(request.scan), "a scan's number"));
  if (!(request.deadline_s > 0.0 && request.deadline_s <= kLongestDeadline)) {
    return failure(bad_request("deadline_s", fmt::format("{} s", request.deadline_s), "above 0, up to 3600 s"));
  }
  return {};
}

Error no_such_job(std::int64_t job) {
  return {.code = ErrorCode::NotFound,
          .device = "analysis",
          .tried = fmt::format("look at job {}", job),
          .seen = "there is no job of this number since the daemon's start",
          .limit = {}};
}

bool is_over(const api::AnalysisReport& report) {
  return report.state != "queued" && report.state != "running";
}

}  // namespace

AnalysisDesk::AnalysisDesk(AnalysisDeskOptions options, const Clock& clock)
    : options_(std::move(options)), clock_(clock) {
  std::error_code ignored;
  std::filesystem::remove_all(options_.folder, ignored);
  thread_ = std::thread([this] { work(); });
}

AnalysisDesk::~AnalysisDesk() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (in_hand_) in_hand_->cancelled = true;
  }
  changed_.notify_all();
  thread_.join();
  std::error_code ignored;
  std::filesystem::remove_all(options_.folder, ignored);
}

Result<api::AnalysisReport> AnalysisDesk::start(const api::AnalysisRequest& request, const std::string& who) {
  GONIO_TRY(check(request));
  const auto job = std::make_shared<Job>();
  job->request = request;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= options_.most_waiting) {
      return failure({.code = ErrorCode::Busy,
                      .device = "analysis",
                      .tried = "queue a job",
                      .seen = fmt::format("{} jobs wait already", waiting_.size()),
                      .limit = {}});
    }
    job->report = {.id = ++last_,
                   .kind = request.kind,
                   .scan = request.scan,
                   .state = "queued",
                   .who = who,
                   .submitted_utc = iso8601(clock_.utc_now())};
    jobs_[last_] = job;
    waiting_.push_back(job);
    forget_old_ones();
    changed_.notify_all();
    return job->report;
  }
}

api::AnalysisList AnalysisDesk::all() const {
  const std::lock_guard lock(mutex_);
  api::AnalysisList list;
  for (auto at = jobs_.rbegin(); at != jobs_.rend(); ++at) list.jobs.push_back(at->second->report);
  return list;
}

Result<api::AnalysisReport> AnalysisDesk::one(std::int64_t job) const {
  const std::lock_guard lock(mutex_);
  const auto found = jobs_.find(job);
  if (found == jobs_.end()) return failure(no_such_job(job));
  return found->second->report;
}

Result<std::string> AnalysisDesk::file(std::int64_t job, const std::string& name) const {
  const Result<api::AnalysisReport> report = one(job);
  if (!report) return failure(report.error());
  const std::string tried = fmt::format("fetch \"{}\" of job {}", name, job);
  if (report->state != "done") {
    return failure({.code = ErrorCode::WrongState,
                    .device = "analysis",
                    .tried = tried,
                    .seen = "the job is " + report->state,
                    .limit = "a job that is done"});
  }
  // Only what the worker named: a path of a client's making opens nothing.
  if (std::ranges::find(report->files, name, &api::AnalysisFile::name) == report->files.end()) {
    return failure({.code = ErrorCode::NotFound,
                    .device = "analysis",
                    .tried = tried,
                    .seen = "it has no such file",
                    .limit = {}});
  }
  std::ifstream in(folder_of(job) + "/" + name, std::ios::binary);
  if (in) return std::string(std::istreambuf_iterator<char>(in), {});
  return failure({.code = ErrorCode::FileUnreadable,
                  .device = "analysis",
                  .tried = tried,
                  .seen = "it is not there any more",
                  .limit = {}});
}

Result<api::AnalysisReport> AnalysisDesk::cancel(std::int64_t job) {
  const std::lock_guard lock(mutex_);
  const auto found = jobs_.find(job);
  if (found == jobs_.end()) return failure(no_such_job(job));
  Job& wanted = *found->second;
  wanted.cancelled = true;
  const auto waits = std::ranges::find(waiting_, found->second);
  if (waits != waiting_.end()) {
    waiting_.erase(waits);
    wanted.report.state = "cancelled";
    wanted.report.ended_utc = iso8601(clock_.utc_now());
  }
  return wanted.report;
}

void AnalysisDesk::work() {
  for (;;) {
    std::shared_ptr<Job> job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
      if (stopping_) return;
      job = waiting_.front();
      waiting_.pop_front();
      job->report.state = "running";
      in_hand_ = job;
    }
    run(job);
    const std::lock_guard lock(mutex_);
    in_hand_.reset();
  }
}

void AnalysisDesk::run(const std::shared_ptr<Job>& job) {
  std::error_code ignored;  // the worker says what it cannot write
  std::filesystem::create_directories(folder_of(job->report.id), ignored);
  const Result<api::AnalysisReport> outcome = ask_worker(*job);
  if (!outcome || outcome->state != "done") std::filesystem::remove_all(folder_of(job->report.id), ignored);
  finish(*job, outcome);
}

// A client's file lies in a folder of its own beside the results, under its own last name. A job as JSON that is short
// enough for a command line is what is left.
Result<std::vector<std::string>> AnalysisDesk::command_of(const Job& job) const {
  const std::string folder = folder_of(job.report.id);
  std::vector<std::string> command{options_.program, "--store", options_.store_file,
                                   "--into",         folder,    "--low-priority"};
  api::AnalysisRequest request = job.request;
  request.other_bytes.clear();
  if (!request.other_file.empty()) {
    const Result<std::string> bytes = api::from_base64(job.request.other_bytes);
    if (!bytes) return failure(bytes.error());
    const std::filesystem::path path =
        std::filesystem::path(folder) / "other" / std::filesystem::path(request.other_file).filename();
    std::error_code ignored;  // the file says what is wrong
    std::filesystem::create_directories(path.parent_path(), ignored);
    GONIO_TRY(write_file(path.string(), *bytes));
    command.insert(command.end(), {"--other", path.string()});
  }
  command.insert(command.end(), {"--job", api::to_json(request)});
  return command;
}

Result<api::AnalysisReport> AnalysisDesk::ask_worker(Job& job) {
  const Result<std::vector<std::string>> command = command_of(job);
  if (!command) return failure(command.error());
  Result<WorkerProcess> worker = WorkerProcess::start(*command);
  if (!worker) return failure(worker.error());
  const Instant deadline = clock_.now() + seconds(job.request.deadline_s);
  std::string last_step = "starting";
  for (;;) {
    const auto line = worker->next_line(clock_, deadline, job.cancelled);
    if (!line) {
      worker->kill();
      return failure(line.error());
    }
    if (!*line) break;
    Result<api::AnalysisReport> news = api::report_from_json<api::AnalysisReport>(**line);
    if (!news) return failure(news.error());
    if (is_over(*news)) return news;
    last_step = news->doing;
    const std::lock_guard lock(mutex_);
    job.report.progress = news->progress;
    job.report.doing = news->doing;
  }
  return failure({.code = ErrorCode::Internal,
                  .device = "analysis",
                  .tried = last_step,
                  .seen = "gonio-analyse ended before its result: " + worker->wait(),
                  .limit = "scans and readings are untouched"});
}

void AnalysisDesk::finish(Job& job, const Result<api::AnalysisReport>& outcome) {
  const std::lock_guard lock(mutex_);
  api::AnalysisReport& report = job.report;
  report.ended_utc = iso8601(clock_.utc_now());
  if (!outcome) {
    report.state = job.cancelled ? "cancelled" : "failed";
    report.error = outcome.error();
    return;
  }
  report.state = outcome->state;
  report.error = outcome->error;
  report.files = outcome->files;
  report.losses = outcome->losses;
  report.facts = outcome->facts;
  report.notes = outcome->notes;
  if (report.state == "done") report.progress = 1.0;
}

// Called with the mutex.
void AnalysisDesk::forget_old_ones() {
  for (auto at = jobs_.begin(); at != jobs_.end() && jobs_.size() > options_.most_kept;) {
    if (!is_over(at->second->report)) {
      ++at;
      continue;
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder_of(at->first), ignored);
    at = jobs_.erase(at);
  }
}

std::string AnalysisDesk::folder_of(std::int64_t job) const {
  return options_.folder + "/" + std::to_string(job);
}

}  // namespace gonio::daemon
