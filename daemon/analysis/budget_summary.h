#pragma once

#include <string>
#include <vector>

#include "daemon/store/store_reader.h"

namespace gonio::analysis {

/// What one kind of component does to a scan's values: those of one kind ("dark visit 12 at 64 us") are one, numbers
/// aside.
struct BudgetLine {
  std::string name;
  double median = 0.0;  ///< of its standard uncertainty over |f|, over the points told from zero
  double worst = 0.0;
};

/// The largest first; "random" is one of them. Empty without a value told from zero.
[[nodiscard]] std::vector<BudgetLine> budget_summary(const daemon::BrdfInfo& brdf);

/// "dark visit 12 at 64 us [shared, u in DN]" is "dark visits".
[[nodiscard]] std::string kind_of_component(const std::string& name);

}  // namespace gonio::analysis
