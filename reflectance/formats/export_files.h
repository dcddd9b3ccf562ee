#pragma once

#include <string>
#include <vector>

#include "reflectance/formats/loss.h"

namespace gonio::formats {

/// One file to be written: the user's name with this suffix.
struct OutputFile {
  std::string suffix;  ///< ".csv", "-550nm.astm"
  std::string bytes;
};

/// What a writer makes: one file or several that belong together, and what they do not hold of what they were given.
struct Export {
  std::vector<OutputFile> files;
  Losses losses;
};

}  // namespace gonio::formats
