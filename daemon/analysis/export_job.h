#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "protocol/api/analysis.h"
#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::analysis {

/// The BRDF in a format of api::kExportFormats. Formats with directions of their own are read off surfaces made of the
/// points. Errors: InvalidInput (no such format; those of its writer).
[[nodiscard]] Result<formats::Export> exported(const formats::MeasuredBrdf& brdf, std::string_view format);

/// The losses in the words of the API.
[[nodiscard]] std::vector<api::AnalysisLoss> losses_of(const formats::Losses& losses);

/// Writes an export's files into `folder`, named `stem` with their suffixes, and lists them.
[[nodiscard]] Result<std::vector<api::AnalysisFile>> write_files(const std::string& folder, const std::string& stem,
                                                                 const formats::Export& written);

}  // namespace gonio::analysis
