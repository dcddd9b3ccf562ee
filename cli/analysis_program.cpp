#include "cli/analysis_program.h"

#include <filesystem>

#include "cli/sibling_program.h"
#include "protocol/api/json.h"

namespace gonio::cli {

namespace fs = std::filesystem;

std::vector<std::string> analysis_command(const FileJob& job, const std::string& own_path) {
  // Never the input's own name: a conversion into its own format would write over what it reads.
  const std::string what = job.format.empty() ? job.kind : job.format == "csv+json" ? "csv" : job.format;
  const fs::path output =
      job.output.empty() ? fs::path(fs::path(job.file).stem().string() + "-" + what + ".x") : fs::path(job.output);
  const std::string folder = output.parent_path().empty() ? "." : output.parent_path().string();
  std::vector<std::string> command{
      sibling_program("gonio-analyse", own_path),
      "--file",
      job.file,
      "--into",
      folder,
      "--name",
      output.stem().string(),
      "--job",
      api::to_json(api::AnalysisRequest{
          .kind = job.kind, .format = job.format, .other_model = job.other_model, .model = job.model})};
  if (!job.other_file.empty()) command.insert(command.end(), {"--other", job.other_file});
  if (!job.as_json) command.emplace_back("--plain");
  return command;
}

Error become_analysis(const FileJob& job) {
  return become_program(analysis_command(job, own_program()), "start gonio-analyse");
}

}  // namespace gonio::cli
