#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace gonio::daemon {

struct StoreComparison {
  std::int64_t rows = 0;               ///< compared, of all tables
  std::int64_t times_that_differ = 0;  ///< values of columns that hold a measured time
};

/// Compares two stores table by table, row by row in the order of the keys, every value to the bit, measured times and
/// process ids aside. Errors: ReplayDiffers (the first difference: table, row, column, both values), StoreFailed.
[[nodiscard]] Result<StoreComparison> compare_stores(const std::string& store, const std::string& against);

}  // namespace gonio::daemon
