#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/store/store_reader.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::analysis {

/// A stored scan with everything that files, plots and reports say of it.
struct StoredScan {
  daemon::ScanInfo info;
  daemon::ScanTexts texts;
  daemon::BrdfInfo brdf;  ///< the newest calibration, or one made of what there is so far
  std::vector<daemon::PointInfo> points;
};

/// Errors: those of the store and of brdf_of.
[[nodiscard]] Result<StoredScan> read_stored_scan(daemon::StoreReader& reader, daemon::ScanId scan);

/// The scan's values with U, k, the shared part and their flags by name; one channel a wavelength; directions as
/// reported by the encoders. Metadata of what the texts say. Errors: InvalidInput when no point has a value.
[[nodiscard]] Result<formats::MeasuredBrdf> measured_brdf(const StoredScan& scan);

/// What a reader of any file of this scan should know: blocked and refused points, flags that every value has, a scan
/// that is not over, a single incidence.
[[nodiscard]] std::vector<std::string> notes_on(const StoredScan& scan, const formats::MeasuredBrdf& brdf);

}  // namespace gonio::analysis
