// gonio-analyse: one job on a store or a file, and what became of it. Started by goniod, or by gonioctl for a file.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/analysis/job.h"
#include "protocol/api/json.h"

namespace gonio::analysis {
namespace {

struct Line {
  JobInput input;
  std::string job;
  bool is_plain = false;
  bool is_low_priority = false;
};

void add_options(CLI::App& app, Line& line) {
  app.set_version_flag("--version", "gonio-analyse " GONIO_VERSION);
  CLI::Option* store = app.add_option("--store", line.input.store_file, "goniod's database, read only");
  app.add_option("--file", line.input.input_file, "a BRDF file of any format that is known")->excludes(store);
  app.add_option("--other", line.input.other_file, "another BRDF file, to compare with");
  app.add_option("--into", line.input.folder, "the folder of the results")->required();
  app.add_option("--name", line.input.name, "what their names begin with [scan-N]");
  app.add_option("--job", line.job, "the job: JSON as POST /api/v1/analysis takes it")->required();
  app.add_flag("--plain", line.is_plain, "tell people, not a daemon");
  app.add_flag("--low-priority", line.is_low_priority, "behind everything else, and ending with what started it");
}

// What goniod needs comes first: the processor, the disk, memory. The worker ends with its daemon.
void step_back() {
  constexpr int kIdleClass = 3 << 13;  // IOPRIO_CLASS_IDLE (linux/ioprio.h, which Debian's headers keep apart)
  constexpr int kThisProcess = 1;      // IOPRIO_WHO_PROCESS
  constexpr int kNicest = 19;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  (void)setpriority(PRIO_PROCESS, 0, kNicest);
  (void)syscall(SYS_ioprio_set, kThisProcess, 0, kIdleClass);
  std::ofstream("/proc/self/oom_score_adj") << "1000\n";
}

Result<api::AnalysisReport> run_line(Line& line, Progress& progress) {
  Result<api::AnalysisRequest> request = api::request_from_json<api::AnalysisRequest>(line.job);
  if (!request) return failure(request.error());
  line.input.request = std::move(*request);
  if (line.input.store_file.empty() && line.input.input_file.empty()) {
    return failure({.code = ErrorCode::InvalidInput, .seen = "neither --store nor --file", .limit = "one of them"});
  }
  if (line.input.name.empty()) line.input.name = "scan-" + std::to_string(line.input.request.scan);
  return run_job(line.input, progress);
}

int run(int argc, char** argv) {
  Line line;
  CLI::App app("gonio-analyse does one job on stored scans or on a BRDF file: goniod and gonioctl start it.",
               "gonio-analyse");
  add_options(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    constexpr int kUsage = 2;
    return app.exit(e) == 0 ? 0 : kUsage;
  }
  if (line.is_low_priority) step_back();
  Progress progress(line.is_plain ? Progress::Form::People : Progress::Form::Lines, std::cout, std::cerr,
                    isatty(STDERR_FILENO) == 1);
  const Result<api::AnalysisReport> done = run_line(line, progress);
  if (done) {
    progress.end(*done);
    return 0;
  }
  progress.end({.state = "failed", .error = done.error()});
  return traits(done.error().code).exit_code;
}

}  // namespace
}  // namespace gonio::analysis

int main(int argc, char** argv) {
  return gonio::analysis::run(argc, argv);
}
