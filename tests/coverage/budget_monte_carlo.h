#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "tests/coverage/coverage_scene.h"

namespace gonio::coverage {

/// The budget by formula beside the spread of values over draws of its inputs (JCGM 101:2008).
struct BudgetComparison {
  int draws = 0;
  double ratio = 0.0;  ///< root mean square over the points of (standard deviation over draws) / u
  double least_point = 0.0, largest_point = 0.0;  ///< of that quotient
  /// Relative: as large as it is for points that share one error. With independent points it is less.
  double standard_error = 0.0;
  std::vector<std::string> as_stated;  ///< components that no input carries: drawn from their own u
};

/// One scan of the scene without any drawn error is what was measured. Each draw disturbs its readings by one draw of
/// every input, from what is told of it alone, and calibrates them anew: noise of each frame, monitor, placing, zeros
/// and repeatability through the true surface, exposure offset, linearity, lamp, darks, certificate and shape through
/// the light of the reference. Nothing is linearised here, and no sensitivity of the code under test is asked for, but
/// for components that stand for what the scan does not say (unresolved slopes, table between nodes). Errors:
/// `calibrate`.
[[nodiscard]] Result<BudgetComparison> compare_budget(const PreparedScene& scene, int draws, std::uint64_t seed,
                                                      int threads);

}  // namespace gonio::coverage
