#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace gonio::cli {

enum class Format : std::uint8_t { Table, Json, Jsonl, Csv };

/// Rows under a header; cells are text already.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// In columns, numbers to the right where all cells of a column are numbers.
void print_table(std::ostream& out, const Table& table);
/// RFC 4180, with a header row.
void print_csv(std::ostream& out, const Table& table);
/// One thing: "name  value" lines.
void print_facts(std::ostream& out, const Table& one_row);

/// "1 h 12 min", "12 min 5 s", "4.2 s".
[[nodiscard]] std::string duration_text(double seconds);
/// Up to `digits` significant digits; empty for nothing.
[[nodiscard]] std::string number_text(double value, int digits = 6);
[[nodiscard]] std::string number_text(const std::optional<double>& value, int digits = 6);

}  // namespace gonio::cli
