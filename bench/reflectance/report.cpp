#include "bench/reflectance/report.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace gonio::bench {

std::string text(const char* format, ...) {
  char buffer[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

std::string time_text(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  const struct {
    double size;
    const char* name;
  } units[] = {{1e-9, "ns"}, {1e-6, "us"}, {1e-3, "ms"}, {1.0, "s"}};
  std::size_t unit = 0;
  while (unit < 3 && seconds >= 999.5 * units[unit].size) ++unit;
  const double value = seconds / units[unit].size;
  return text(value < 9.95 ? "%.1f %s" : "%.0f %s", value, units[unit].name);
}

std::string Table::markdown() const {
  std::vector<std::size_t> widths(rows_.front().size(), 3);
  for (const auto& row : rows_) {
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string all;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::string room(widths[k] - cells[k].size(), ' ');
      all += k == 0 ? "| " + cells[k] + room : " | " + room + cells[k];
    }
    all += " |\n";
  };
  line(rows_.front());
  for (std::size_t k = 0; k < widths.size(); ++k) {
    all += k == 0 ? "|" + std::string(widths[k] + 2, '-') : "|" + std::string(widths[k] + 1, '-') + ":";
  }
  all += "|\n";
  for (std::size_t n = 1; n < rows_.size(); ++n) line(rows_[n]);
  return all;
}

std::ofstream file_in(const std::filesystem::path& folder, const std::string& name) {
  std::ofstream file(folder / name);
  if (file) return file;
  std::fprintf(stderr, "cannot write %s\n", (folder / name).c_str());
  std::exit(2);
}

}  // namespace gonio::bench
