#include "cli/analysis_job.h"

#include <poll.h>

#include <charconv>
#include <filesystem>
#include <ostream>

#include "base/read_file.h"
#include "base/write_file.h"
#include "cli/output.h"
#include "protocol/api/base64.h"

namespace gonio::cli {
namespace {

constexpr int kBetweenJobLooksMs = 100;

bool is_job_over(const api::AnalysisReport& job) {
  return job.state != "queued" && job.state != "running";
}

// One line, rewritten; nothing where nobody sits before it.
class JobLine {
 public:
  explicit JobLine(World& world) : world_(world) {}
  void show(const api::AnalysisReport& job) {
    if (!world_.out_is_terminal) return;
    const int percent = static_cast<int>(100.0 * job.progress);
    std::string text = "job " + std::to_string(job.id) + ": " + std::to_string(percent) + " % " +
                       (job.doing.empty() ? job.state : job.doing);
    const std::size_t blanks = text.size() < shown_ ? shown_ - text.size() : 0;
    world_.err << '\r' << text << std::string(blanks, ' ') << std::flush;
    shown_ = text.size();
  }
  ~JobLine() {
    if (shown_ > 0) world_.err << '\r' << std::string(shown_, ' ') << '\r' << std::flush;
  }
  JobLine(const JobLine&) = delete;
  JobLine& operator=(const JobLine&) = delete;

 private:
  World& world_;
  std::size_t shown_ = 0;
};

// The interrupted client refuses to speak: cancelling needs one of its own.
void cancel_job(DaemonClient& client, std::int64_t job) {
  const std::atomic<bool> not_interrupted{false};
  Result<HttpClient> http = HttpClient::open(client.connect(), not_interrupted);
  if (!http) return;
  DaemonClient other(std::move(*http), client.connect());
  (void)other.post<api::AnalysisReport>(api::RouteId::AnalysisCancel, job, "{}");
}

std::string name_here(const std::string& name, const std::string& stem, const std::string& output, bool is_only) {
  if (output.empty()) return name;
  if (is_only) return output;
  const std::filesystem::path path(output);
  const std::string tail = name.starts_with(stem) ? name.substr(stem.size()) : "-" + name;
  return (path.parent_path() / (path.stem().string() + tail)).string();
}

}  // namespace

std::optional<std::int64_t> scan_number(const std::string& text) {
  std::int64_t scan = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), scan);
  if (error != std::errc() || end != text.data() + text.size() || scan <= 0) return std::nullopt;
  return scan;
}

Result<api::AnalysisRequest> comparison_request(const std::string& other, bool with_bytes) {
  api::AnalysisRequest request{.kind = "compare"};
  std::error_code ignored;
  if (const auto scan = scan_number(other)) {
    request.other_scan = *scan;
  } else if (!std::filesystem::is_regular_file(other, ignored)) {
    request.other_model = other;
  } else {
    request.other_file = other;
    if (!with_bytes) return request;
    const Result<std::string> bytes = read_file(other);
    if (!bytes) return failure(bytes.error());
    request.other_bytes = api::to_base64(*bytes);
  }
  return request;
}

Result<api::AnalysisReport> run_analysis(DaemonClient& client, const api::AnalysisRequest& request, World& world) {
  auto job = client.post<api::AnalysisReport>(api::RouteId::AnalysisStart, 0, api::to_json(request));
  if (!job) return failure(job.error());
  const std::int64_t id = job->value.id;
  JobLine line(world);
  while (!is_job_over(job->value)) {
    line.show(job->value);
    poll(nullptr, 0, kBetweenJobLooksMs);
    job = client.get<api::AnalysisReport>(api::RouteId::AnalysisOne, id);
    if (job) continue;
    if (world.interrupted) cancel_job(client, id);
    return failure(job.error());
  }
  if (job->value.error) return failure(*job->value.error);
  return job->value;
}

Result<std::vector<std::string>> take_files(DaemonClient& client, const api::AnalysisReport& job,
                                            const std::string& output, World& world) {
  std::vector<std::string> written;
  const std::string stem = "scan-" + std::to_string(job.scan);
  for (const api::AnalysisFile& file : job.files) {
    const Result<std::string> bytes = client.text(api::RouteId::AnalysisFile, job.id, "name=" + file.name);
    if (!bytes) return failure(bytes.error());
    if (output == "-" && job.files.size() == 1) {
      world.out << *bytes << std::flush;
      continue;
    }
    const std::string name = name_here(file.name, stem, output == "-" ? "" : output, job.files.size() == 1);
    GONIO_TRY(write_file(name, *bytes));
    written.push_back(name);
  }
  return written;
}

void tell(const api::AnalysisReport& job, const std::vector<std::string>& written, World& world) {
  Table table{.header = {"quantity", "value", "U", "unit", "note"}, .rows = {}};
  for (const api::AnalysisFact& fact : job.facts) {
    table.rows.push_back({fact.name, number_text(fact.value), number_text(fact.expanded_u, 2),
                          fact.unit == "1" ? "" : fact.unit, fact.note});
  }
  if (!table.rows.empty()) print_table(world.out, table);
  for (const api::AnalysisLoss& loss : job.losses) {
    world.err << "not in the file: " << loss.kind;
    if (loss.values > 0) world.err << " (" << loss.values << " values)";
    world.err << ": " << loss.what << '\n';
  }
  for (const std::string& note : job.notes) world.err << "note: " << note << '\n';
  for (const std::string& name : written) world.err << "written: " << name << '\n';
}

}  // namespace gonio::cli
