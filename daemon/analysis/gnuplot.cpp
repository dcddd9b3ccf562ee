#include "daemon/analysis/gnuplot.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "base/clock.h"
#include "base/write_file.h"
#include "daemon/analysis/worker_process.h"

namespace gonio::analysis {
namespace {

constexpr std::chrono::minutes kPatience{1};

Result<std::string> run_gnuplot(const std::string& folder, const std::string& commands, const std::string& script) {
  // By env, which searches the path; a missing program is its exit code 127.
  Result<daemon::WorkerProcess> process = daemon::WorkerProcess::start(
      {"/usr/bin/env", "-C", folder.empty() ? "." : folder, "gnuplot", "-e", commands, script});
  if (!process) return failure(process.error());
  const SystemClock clock;
  const Instant deadline = clock.now() + kPatience;
  const std::atomic<bool> not_cancelled{false};
  for (;;) {
    const auto line = process->next_line(clock, deadline, not_cancelled);
    if (!line) return failure(line.error());
    if (!*line) break;
  }
  return process->wait();
}

Error gnuplot_error(const std::string& script, const std::string& end) {
  const bool is_missing = end.starts_with("exit code 127");
  return {.code = is_missing ? ErrorCode::FileUnreadable : ErrorCode::Internal,
          .device = "gnuplot",
          .tried = "draw " + script,
          .seen = is_missing ? "there is no gnuplot" : end,
          .limit = is_missing ? "Debian's package gnuplot-nox" : ""};
}

std::string terminal(const std::string& kind, const Picture& picture) {
  const std::string size =
      fmt::format("size {},{} noenhanced background rgb 'white'", picture.width_px, picture.height_px);
  return kind == "png" ? "set terminal pngcairo " + size + " font 'sans,11'"
                       : "set terminal svg " + size + " font 'sans,13' dynamic";
}

Result<void> draw_one(const std::string& folder, const std::string& base, const std::string& kind,
                      const Picture& picture) {
  const std::string aside = fmt::format("{}.{}.part-{}", base, kind, getpid());
  const std::string commands = terminal(kind, picture) + "; set encoding utf8; set output " + in_quotes(aside);
  const Result<std::string> end = run_gnuplot(folder, commands, base + ".gnuplot");
  if (!end) return failure(end.error());
  const std::string path = folder + "/" + aside;
  std::error_code ignored;
  if (!end->starts_with("exit code 0")) {
    std::filesystem::remove(path, ignored);
    return failure(gnuplot_error(base + ".gnuplot", *end));
  }
  if (std::rename(path.c_str(), (folder + "/" + base + "." + kind).c_str()) == 0) return {};
  std::filesystem::remove(path, ignored);
  return failure(gnuplot_error(base + ".gnuplot", "its picture cannot be renamed"));
}

std::string with_header(const std::string& base, const Picture& picture) {
  return fmt::format("# Again: gnuplot -e \"{}; set encoding utf8; set output '{}.svg'\" {}.gnuplot\n",
                     terminal("svg", picture), base, base) +
         picture.script;
}

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string made = "'";
  for (const char c : text) {
    const bool is_control = static_cast<unsigned char>(c) < 0x20;
    if (c == '\'') made += '\'';
    made += is_control ? ' ' : c;
  }
  return made + "'";
}

Result<std::vector<api::AnalysisFile>> draw(const std::string& folder, const std::string& stem,
                                            const Picture& picture) {
  const std::string base = stem + "-" + picture.name;
  std::vector<std::string> names{base + ".png", base + ".svg"};
  for (const auto& [name, text] : picture.tables) {
    GONIO_TRY(write_file(folder + "/" + name, text));
    names.push_back(name);
  }
  GONIO_TRY(write_file(folder + "/" + base + ".gnuplot", with_header(base, picture)));
  names.push_back(base + ".gnuplot");
  for (const char* kind : {"png", "svg"}) GONIO_TRY(draw_one(folder, base, kind, picture));
  std::vector<api::AnalysisFile> files;
  for (const std::string& name : names) {
    std::error_code ignored;
    files.push_back(
        {.name = name, .bytes = static_cast<std::int64_t>(std::filesystem::file_size(folder + "/" + name, ignored))});
  }
  return files;
}

}  // namespace gonio::analysis
