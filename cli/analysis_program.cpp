#include "cli/analysis_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

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
      (fs::path(own_path).parent_path() / "gonio-analyse").string(),
      "--file",
      job.file,
      "--into",
      folder,
      "--name",
      output.stem().string(),
      "--job",
      api::to_json(api::AnalysisRequest{.kind = job.kind, .format = job.format, .model = job.model})};
  if (!job.as_json) command.emplace_back("--plain");
  return command;
}

Error become_analysis(const FileJob& job) {
  std::error_code ignored;
  const std::vector<std::string> command = analysis_command(job, fs::read_symlink("/proc/self/exe", ignored).string());
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  execv(words[0], words.data());
  return {.code = ErrorCode::FileUnreadable,
          .device = "gonioctl",
          .tried = "start gonio-analyse",
          .seen = std::strerror(errno),
          .limit = {},
          .where = InputLocation{command[0], 0, {}}};
}

}  // namespace gonio::cli
