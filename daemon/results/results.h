#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/store/store_reader.h"
#include "protocol/api/reports.h"

namespace gonio::daemon {

/// Every point of a scan by index, with its value where there is one, and what became of it where not.
/// Errors: those of brdf_of and of the store.
[[nodiscard]] Result<std::vector<api::BrdfReport>> results_of(StoreReader& reader, ScanId scan);

/// The same as a CSV text: `#` lines with what it rests on, then columns with their units.
[[nodiscard]] Result<std::string> export_csv(StoreReader& reader, ScanId scan, const std::string& software);

/// U/|f| of the values that are told from zero.
struct RelativeUncertainty {
  std::int64_t values = 0;
  std::optional<double> median;
  std::optional<double> worst;
};
[[nodiscard]] RelativeUncertainty relative_uncertainty(const BrdfInfo& brdf);

}  // namespace gonio::daemon
