#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace gonio::calibration {

/// `# key: value` in a CSV, with the line it stands on.
struct CsvNote {
  std::string key;
  std::string value;
  int line = 0;
};

/// One line of cells; as many as there are columns.
struct CsvRow {
  std::vector<std::string_view> cells;
  int line = 0;
};

/// A lab's CSV: notes and comments behind `#`, one line of column names, rows of cells. A note's key is one word of
/// small letters, digits and `_`; what stands behind `#` otherwise is a comment. Empty lines count for nothing, a byte
/// order mark and CR LF neither. The text must outlive it. Threads: any.
class CsvLines {
 public:
  /// `known`: the columns that may stand there. Errors, with file, line and field: InvalidInput (no names, no row, a
  /// column twice, a row of another length), UnknownKey.
  [[nodiscard]] static Result<CsvLines> read(std::string_view text, const std::string& file,
                                             const std::vector<std::string_view>& known);

  [[nodiscard]] const std::vector<CsvNote>& notes() const { return notes_; }
  [[nodiscard]] const std::vector<CsvRow>& rows() const { return rows_; }
  [[nodiscard]] int names_line() const { return names_line_; }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::optional<std::size_t> column(std::string_view name) const;

  /// A finite number, all of `text`. Errors: InvalidInput.
  [[nodiscard]] Result<double> number(std::string_view text, int line, std::string_view field) const;
  [[nodiscard]] Error wrong(ErrorCode code, int line, std::string_view field, std::string seen,
                            std::string limit) const;

 private:
  explicit CsvLines(std::string file) : file_(std::move(file)) {}
  [[nodiscard]] Result<void> read_names(std::string_view line, const std::vector<std::string_view>& known);
  [[nodiscard]] Result<void> read_row(std::string_view line);
  void read_note(std::string_view line);

  std::string file_;
  int line_ = 0;
  int names_line_ = 0;
  std::vector<std::string> names_;
  std::vector<CsvNote> notes_;
  std::vector<CsvRow> rows_;
};

/// As it can be shown in a message: short, and without control characters.
[[nodiscard]] std::string shown_text(std::string_view text);
/// As a TOML basic string, quotes included.
[[nodiscard]] std::string toml_text(std::string_view text);

}  // namespace gonio::calibration
