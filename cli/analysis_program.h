#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace gonio::cli {

/// A job on a file, which needs no daemon.
struct FileJob {
  std::string kind;         ///< "export", "describe", "plot", "quantities", "fit", "symmetry", "compare"
  std::string file;         ///< of any format that is known
  std::string format;       ///< of an export
  std::string model;        ///< of a fit; empty: the usual ones
  std::string other_file;   ///< compare: with this file, or
  std::string other_model;  ///< with this model
  std::string output;  ///< where to; what stands before its last dot names the results. Empty: beside here, by the file
  bool as_json = false;
};

/// The gonio-analyse command that does it; the program is the one beside this one.
[[nodiscard]] std::vector<std::string> analysis_command(const FileJob& job, const std::string& own_path);

/// Becomes it: output and exit code are gonio-analyse's. Returns only when that failed. Errors: FileUnreadable.
[[nodiscard]] Error become_analysis(const FileJob& job);

}  // namespace gonio::cli
