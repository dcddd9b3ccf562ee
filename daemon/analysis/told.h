#pragma once

#include <string>
#include <utility>
#include <vector>

#include "daemon/analysis/picture.h"
#include "protocol/api/analysis.h"

namespace gonio::analysis {

/// What was found of one channel: what a job's report says, and what becomes files.
struct Told {
  std::vector<api::AnalysisFact> facts;
  std::vector<std::string> notes;
  std::vector<std::pair<std::string, std::string>> texts;  ///< by the end of the file's name: ".toml", "-pairs.csv"
  std::vector<Picture> pictures;
};

}  // namespace gonio::analysis
