#pragma once

#include <string>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "calibration/reference_standard.h"
#include "calibration/shape_check.h"

namespace gonio::daemon {

/// One file of the shelf: a standard, or why it is none. One whose table contradicts itself is none.
struct ShelfEntry {
  std::string file;
  std::string text;
  Result<calibration::ReferenceStandard> standard;
  calibration::ShapeReport shape{};  ///< of a standard that could be read
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

  /// Puts a standard on the shelf, whole or not at all: aside, made durable, renamed. It goes to the file that has its
  /// serial number, else to SERIAL.toml; a text that it replaces is kept beside it as FILE.until-TIME. The folder is
  /// made if there is none. Says what became of it in a sentence.
  /// Errors: InvalidInput (a serial number that is no file name; the system's word), DiskFull; WrongState (there is
  /// another text, and `replace` was not said).
  [[nodiscard]] Result<std::string> put(const std::string& serial, const std::string& text, bool replace,
                                        UtcTime now) const;

  [[nodiscard]] const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
};

}  // namespace gonio::daemon
