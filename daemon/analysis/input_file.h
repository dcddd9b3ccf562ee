#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "reflectance/formats/format.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::analysis {

/// A file that somebody brought, and what format it turned out to be.
struct InputFile {
  formats::Format format = formats::Format::Csv;
  formats::MeasuredBrdf brdf;
  std::vector<std::string> notes;  ///< what was taken for granted
};

/// Reads whatever `detect_format` finds; the JSON beside a CSV goes with it. Errors: FileUnreadable, those of
/// `formats::read_brdf`.
[[nodiscard]] Result<InputFile> read_input_file(const std::string& path);

}  // namespace gonio::analysis
