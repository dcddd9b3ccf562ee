#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calibration/reference_standard.h"

namespace gonio::daemon {

/// One file of the shelf: a standard, or why it is none.
struct ShelfEntry {
  std::string file;
  std::string text;
  Result<calibration::ReferenceStandard> standard;
};

/// The reference standards of a folder, reference/*.toml. Read anew at each asking: a new certificate counts from the
/// next plan on. Threads: any.
class ReferenceShelf {
 public:
  explicit ReferenceShelf(std::string folder) : folder_(std::move(folder)) {}

  /// By file name; a folder that is not there is an empty shelf.
  [[nodiscard]] std::vector<ShelfEntry> all() const;
  /// Errors: InvalidInput (no such serial number; those there are), and what is wrong with the file of that name.
  [[nodiscard]] Result<ShelfEntry> find(const std::string& serial) const;

  [[nodiscard]] const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
};

}  // namespace gonio::daemon
