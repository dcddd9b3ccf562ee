#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/analysis/picture.h"
#include "protocol/api/analysis.h"

namespace gonio::analysis {

/// Draws a picture as STEM-NAME.png and .svg, and leaves its tables and its script STEM-NAME.gnuplot beside them; all
/// of them, in that order. Each picture is drawn aside, then renamed. Errors: FileUnreadable (no gnuplot), Internal
/// (gnuplot refused the script, with its words), TimedOut (a minute), DiskFull.
[[nodiscard]] Result<std::vector<api::AnalysisFile>> draw(const std::string& folder, const std::string& stem,
                                                          const Picture& picture);

}  // namespace gonio::analysis
