#pragma once

#include <filesystem>
#include <string>

namespace gonio::fuzz {

/// A folder of this process, in memory where the machine has such a place; gone with the process.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Writes a file anew.
  void write(const std::string& name, std::string_view text) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace gonio::fuzz
