#pragma once

#include <string>
#include <string_view>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// HDF5 in NeXus layout (".nxs"), lossless: /entry (NXentry) with sample, instrument and data (NXdata, signal `f`), one
/// dataset a column of our CSV, units as attributes, `f_errors` for the standard uncertainty, and the CSV's sidecar as
/// /entry/sidecar (NXnote). Made and read in memory. Threads: one at a time in the whole program, which a lock here
/// sees to (Debian's HDF5 is not thread-safe). Errors: as `check`; Internal when the library fails.
[[nodiscard]] Result<Export> write_nexus(const MeasuredBrdf& brdf);

/// Files of this layout. Errors: InvalidInput, naming the dataset: no HDF5, one that is absent, of another length or
/// type than `f`'s, longer than the file.
[[nodiscard]] Result<MeasuredBrdf> read_nexus(std::string_view bytes, const std::string& file);

}  // namespace gonio::formats
