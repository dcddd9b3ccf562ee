#pragma once

#include "base/result.h"
#include "calibration/calibrated_scan.h"
#include "daemon/store/records.h"
#include "daemon/store/store_reader.h"

namespace gonio::daemon {

/// The BRDF of what a scan has so far, from its stored readings and the texts it was accepted with: nothing else
/// counts. Errors: those of the store, of the texts, of calibrate.
[[nodiscard]] Result<NewBrdf> compute_brdf(StoreReader& reader, ScanId scan);

/// The newest stored BRDF, or the one of what there is so far.
[[nodiscard]] Result<BrdfInfo> brdf_of(StoreReader& reader, ScanId scan);

/// Uncertainties of a stored value, put together again.
struct StoredBudget {
  double u_shared_per_sr = 0.0;
  double u_per_sr = 0.0;
  double k = 2.0;
  double expanded_per_sr = 0.0;
};
[[nodiscard]] StoredBudget budget_of(const BrdfRow& row);

}  // namespace gonio::daemon
