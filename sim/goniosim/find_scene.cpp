#include "sim/goniosim/find_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

namespace gonio::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBench = "bench";  // what scenes share is no scene

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() == ".toml" && name != kBench) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace

Result<std::string> find_scene(const std::string& scene, const std::string& executable) {
  std::error_code ignored;
  if (fs::is_regular_file(scene, ignored)) return scene;
  const fs::path here = fs::path(executable).parent_path();
  std::vector<std::string> known;
  for (const fs::path& folder : {here / "scenes", here / ".." / "share" / "goniod" / "scenes"}) {
    const fs::path candidate = folder / (scene + ".toml");
    if (fs::is_regular_file(candidate, ignored)) return candidate.string();
    for (std::string& name : names_in(folder)) known.push_back(std::move(name));
  }
  return failure({.code = ErrorCode::FileUnreadable,
                  .device = "goniosim",
                  .tried = fmt::format("open the scene \"{}\"", scene),
                  .seen = "it is neither a file nor the name of a scene",
                  .limit = known.empty() ? std::string() : fmt::format("one of: {}", fmt::join(known, ", "))});
}

std::string this_executable() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).string();
}

}  // namespace gonio::sim
