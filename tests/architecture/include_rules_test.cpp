// Holds the diagram of the rooms: who may include whom, and that each foreign library is met in one adapter a room.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace gonio {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path kRoot = GONIO_SOURCE_DIR;

// A room may include itself and these.
const std::map<std::string, Names>& allowed() {
  static const std::map<std::string, Names> kAllowed{
      {"base", {}},
      {"reflectance", {"base"}},
      {"reflectance/formats", {"reflectance", "base"}},
      {"reflectance/fit", {"reflectance", "base"}},
      {"calibration", {"reflectance", "base"}},
      {"protocol/stage", {"base"}},
      {"protocol/usbtmc", {"base"}},
      {"protocol/api", {"base"}},
      {"drivers", {"protocol/stage", "protocol/usbtmc", "base"}},
      {"sim", {"protocol/stage", "protocol/usbtmc", "reflectance", "reflectance/formats", "base"}},
      {"cli", {"protocol/api", "base"}},
      {"daemon",
       {"daemon/analysis", "drivers", "calibration", "reflectance", "reflectance/formats", "protocol/stage",
        "protocol/api", "base"}},
      // The worker program, the only one with Ceres.
      {"daemon/analysis",
       {"daemon", "calibration", "reflectance", "reflectance/formats", "reflectance/fit", "protocol/api", "base"}},
  };
  return kAllowed;
}

// Header prefix of a foreign library, and in how many files of one room it may appear: one, its adapter.
const std::vector<std::string>& foreign_headers() {
  static const std::vector<std::string> kForeign{"modbus", "arv.h",   "SQLiteCpp/", "sqlite3.h", "microhttpd.h",
                                                 "curl/",  "toml++/", "CLI/",       "libusb",    "umockdev.h",
                                                 "hdf5",   "ceres/",  "Eigen/"};
  return kForeign;
}

bool starts_with_path(const std::string& path, const std::string& room) {
  return path.size() > room.size() && path.compare(0, room.size(), room) == 0 && path[room.size()] == '/';
}

// A room may lie in another's folder: the longest name that fits.
std::string room_of(const std::string& path) {
  std::string room;
  for (const auto& [name, may] : allowed()) {
    if (starts_with_path(path, name) && name.size() > room.size()) room = name;
  }
  return room;
}

struct Include {
  std::string file;
  std::string header;
  bool ours = false;
};

std::vector<Include> includes_below(const std::string& room) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::vector<Include> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kRoot / room)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".cpp") continue;
    if (room_of(fs::relative(entry.path(), kRoot).string()) != room) continue;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, kInclude)) continue;
      found.push_back({fs::relative(entry.path(), kRoot).string(), match[2], match[1] == "\""});
    }
  }
  return found;
}

TEST(IncludeRules, AreKeptByEveryRoom) {
  std::size_t looked_at = 0;
  for (const auto& [room, may] : allowed()) {
    for (const Include& include : includes_below(room)) {
      ++looked_at;
      const std::string other = room_of(include.header);
      EXPECT_TRUE(other.empty() || other == room || may.contains(other))
          << include.file << " includes " << include.header;
      EXPECT_FALSE(starts_with_path(include.header, "tests")) << include.file;
    }
  }
  EXPECT_GT(looked_at, 100U) << "the source tree was not found below " << kRoot;
}

TEST(IncludeRules, OwnHeadersAreNamedFromTheRoot) {
  for (const auto& [room, may] : allowed()) {
    for (const Include& include : includes_below(room)) {
      if (!include.ours) continue;
      EXPECT_TRUE(fs::exists(kRoot / include.header)) << include.file << " includes " << include.header;
    }
  }
}

TEST(IncludeRules, EachForeignLibraryHasOneAdapterARoom) {
  for (const auto& [room, may] : allowed()) {
    std::map<std::string, Names> users;
    for (const Include& include : includes_below(room)) {
      for (const std::string& library : foreign_headers()) {
        if (!include.ours && include.header.rfind(library, 0) == 0) users[library].insert(include.file);
      }
    }
    for (const auto& [library, files] : users) {
      EXPECT_LE(files.size(), 1U) << room << " meets <" << library << "...> in more than one file, first "
                                  << *files.begin();
    }
  }
}

TEST(IncludeRules, EveryRoomHasItsReadme) {
  for (const auto& [room, may] : allowed()) {
    EXPECT_TRUE(fs::exists(kRoot / room / "README.md")) << room;
  }
}

}  // namespace
}  // namespace gonio
