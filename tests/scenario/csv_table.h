#pragma once

#include <map>
#include <string>
#include <vector>

namespace gonio::test {

/// A CSV as our programs write it: `# key: value` lines, a row of names, rows of values without quotes.
struct CsvTable {
  std::map<std::string, std::string> metadata;
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;  ///< by name of the column
};
[[nodiscard]] CsvTable parse_csv(const std::string& text);

}  // namespace gonio::test
