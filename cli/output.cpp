#include "cli/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace gonio::cli {
namespace {

bool is_number(const std::string& cell) {
  return !cell.empty() && cell.find_first_not_of("0123456789+-.e") == std::string::npos;
}

bool is_number_column(const Table& table, std::size_t column) {
  return !table.rows.empty() && std::ranges::all_of(table.rows, [column](const auto& row) {
    return row[column].empty() || is_number(row[column]);
  });
}

std::string csv_cell(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

void print_csv_row(std::ostream& out, const std::vector<std::string>& row) {
  for (std::size_t i = 0; i < row.size(); ++i) out << (i == 0 ? "" : ",") << csv_cell(row[i]);
  out << '\n';
}

}  // namespace

void print_table(std::ostream& out, const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    std::size_t width = table.header[i].size();
    for (const auto& row : table.rows) width = std::max(width, row[i].size());
    widths.push_back(width);
  }
  const auto print_row = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool right = is_number_column(table, i);
      line += right ? fmt::format("{:>{}}", row[i], widths[i]) : fmt::format("{:<{}}", row[i], widths[i]);
      if (i + 1 < row.size()) line += "  ";
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << '\n';
  };
  print_row(table.header);
  for (const auto& row : table.rows) print_row(row);
}

void print_csv(std::ostream& out, const Table& table) {
  print_csv_row(out, table.header);
  for (const auto& row : table.rows) print_csv_row(out, row);
}

void print_facts(std::ostream& out, const Table& one_row) {
  std::size_t width = 0;
  for (const std::string& name : one_row.header) width = std::max(width, name.size());
  for (std::size_t i = 0; i < one_row.header.size(); ++i) {
    if (one_row.rows[0][i].empty()) continue;
    out << fmt::format("{:<{}}  {}\n", one_row.header[i], width, one_row.rows[0][i]);
  }
}

std::string duration_text(double seconds) {
  constexpr double kMinute = 60.0;
  constexpr double kHour = 3600.0;
  if (seconds < kMinute) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (seconds < kHour) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string number_text(double value, int digits) {
  return fmt::format("{:.{}g}", value, digits);
}

std::string number_text(const std::optional<double>& value, int digits) {
  return value ? number_text(*value, digits) : std::string();
}

}  // namespace gonio::cli
