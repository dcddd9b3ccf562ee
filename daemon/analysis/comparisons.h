#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/analysis/told.h"
#include "reflectance/measured/measured_scan.h"
#include "reflectance/surface/surface.h"
#include "reflectance/table/tabulated_surface.h"

// Scans beside something that should agree with them: facts, a table (CSV), a picture of the deviations. `stem` is what
// the names of the tables begin with. z is a difference over the u (k = 1) of what does not cancel in it; U = 2 u.
namespace gonio::analysis {

/// Two scans; notes say what both share and how much of it cancels. Errors: as compare_scans.
[[nodiscard]] Result<Told> scans_compared(const reflectance::MeasuredScan& first,
                                          const reflectance::MeasuredScan& second, const std::string& stem);

/// A surface that is taken for exact, or that was fitted to this very scan by `spent` numbers.
struct ComparedSurface {
  std::string name;  ///< "rpv rho0=0.133 k=0.851 g=-0.114"
  reflectance::Surface surface;
  std::size_t spent = 0;
};
/// Errors: as compare_with_surface.
[[nodiscard]] Result<Told> surface_compared(const reflectance::MeasuredScan& scan, const ComparedSurface& other,
                                            const std::string& stem);

/// Another's readings, and the table between them: their uncertainties count. Errors: as compare_with_table.
struct ComparedTable {
  std::string name;
  const reflectance::TabulatedSurface& table;
  const reflectance::MeasuredScan& readings;
};
[[nodiscard]] Result<Told> table_compared(const reflectance::MeasuredScan& scan, const ComparedTable& other,
                                          const std::string& stem);

/// Reciprocity; for samples that are declared isotropic left and right of the plane of incidence, and turns about the
/// normal. A table of all pairs, a picture for each symmetry that has any. Errors: as check_symmetry.
[[nodiscard]] Result<Told> symmetries_told(const reflectance::MeasuredScan& scan, const std::string& stem);

/// The spread of each point over several scans of one sample beside its u, between the scans and within them. Errors:
/// as repeatability.
[[nodiscard]] Result<Told> repeatability_told(const std::vector<reflectance::MeasuredScan>& scans,
                                              const std::string& stem);

}  // namespace gonio::analysis
