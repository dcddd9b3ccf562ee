#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace gonio::bench {

/// A table that goes to stdout and, as Markdown, into a file. Columns are as wide as their widest cell.
class Table {
 public:
  explicit Table(std::vector<std::string> heads) : rows_{std::move(heads)} {}
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  [[nodiscard]] std::string markdown() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// printf for strings.
[[nodiscard]] [[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);

/// A time with two digits and the unit that fits: "85 ns", "1.2 ms".
[[nodiscard]] std::string time_text(double seconds);

/// A file to write into; ends the program when it cannot be made.
[[nodiscard]] std::ofstream file_in(const std::filesystem::path& folder, const std::string& name);

}  // namespace gonio::bench
