#pragma once

#include "base/result.h"
#include "calibration/calibrated_scan.h"
#include "daemon/results/version_desk.h"
#include "daemon/store/records.h"
#include "daemon/store/store_reader.h"

namespace gonio::daemon {

/// The BRDF of what a scan has so far, from its stored readings, the texts it was accepted with and what calibration
/// jobs have found: nothing else counts. Errors: those of the store, of the texts, of model_with, of calibrate.
[[nodiscard]] Result<NewBrdf> compute_brdf(StoreReader& reader, ScanId scan, const AskedVersions& asked = {});

/// The newest stored BRDF, or the one of what there is so far.
[[nodiscard]] Result<BrdfInfo> brdf_of(StoreReader& reader, ScanId scan);

/// Whether each scan draws this component anew; every other shared part is the instrument's or the standard's.
[[nodiscard]] bool is_drawn_anew(std::string_view component);

/// Uncertainties of a stored value, put together again.
struct StoredBudget {
  double u_shared_per_sr = 0.0;
  double u_per_sr = 0.0;
  double k = 2.0;
  double expanded_per_sr = 0.0;
  double below_per_sr = 0.0;  ///< the 95.45 % interval is [value - below, value + above]; U is the larger
  double above_per_sr = 0.0;
};
[[nodiscard]] StoredBudget budget_of(const BrdfRow& row);

}  // namespace gonio::daemon
