#pragma once

#include <string>

#include "base/result.h"
#include "calibration/reference_standard.h"
#include "calibration/shape_check.h"

namespace gonio::calibration {

/// What a lab has of its standard.
struct ReferenceSource {
  std::string text;        ///< a whole reference/*.toml, one without [shape], or a certificate as CSV (reference_csv.h)
  std::string file;        ///< the user's name for it; `.csv` says what it is
  std::string shape_text;  ///< a shape as CSV; empty: none
  std::string shape_file;
  const ReferenceStandard* shape_from = nullptr;  ///< or the shape and modes of another standard
};

struct ImportedReference {
  std::string text;  ///< of a whole reference/*.toml; the user's own, when it was one
  ReferenceStandard standard;
  ShapeReport shape;  ///< whatever its verdict
};

/// Puts the parts together, reads the whole and looks at its table. The verdict is the caller's to ask for
/// (demand_consistency).
/// Errors: those of parse_reference and of the CSVs, at the file, line and field of the user's own text; InvalidInput
/// (two shapes, or a shape on top of a whole file); ReferenceIncomplete (no shape).
[[nodiscard]] Result<ImportedReference> import_reference(const ReferenceSource& source);

}  // namespace gonio::calibration
