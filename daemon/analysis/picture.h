#pragma once

#include <string>
#include <utility>
#include <vector>

namespace gonio::analysis {

/// A picture to be drawn by gnuplot: its tables, and a script that reads them by these names from its own folder. The
/// script sets neither terminal nor output. Texts in it are plain (no enhanced mode), in UTF-8.
struct Picture {
  std::string name;     ///< part of its files' names: "lobe", "cut-550nm"
  std::string caption;  ///< a sentence, for the report
  std::string script;
  std::vector<std::pair<std::string, std::string>> tables;  ///< file name, text
  int width_px = 1200;
  int height_px = 500;
};

/// A text between single quotes in a gnuplot script, on one line.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace gonio::analysis
