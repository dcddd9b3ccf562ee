#include "tests/scenario/csv_table.h"

#include <sstream>

namespace gonio::test {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

}  // namespace

CsvTable parse_csv(const std::string& text) {
  CsvTable table;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("# ", 0) == 0) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos) table.metadata[line.substr(2, colon - 2)] = line.substr(colon + 2);
    } else if (table.names.empty()) {
      table.names = cells_of(line);
    } else if (!line.empty()) {
      const std::vector<std::string> cells = cells_of(line);
      table.rows.emplace_back();
      for (std::size_t i = 0; i < cells.size() && i < table.names.size(); ++i) {
        table.rows.back()[table.names[i]] = cells[i];
      }
    }
  }
  return table;
}

}  // namespace gonio::test
