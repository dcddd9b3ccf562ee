#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace gonio::formats {

/// The lines of a text, one after the other, with what an error needs to say where it stands. The text must outlive it.
class TextLines {
 public:
  /// `format` as in "ASTM text", `file` the user's name for it.
  TextLines(std::string_view text, std::string format, std::string file);

  /// The next line without its end (LF or CR LF); absent at the end of the text.
  [[nodiscard]] std::optional<std::string_view> next();
  /// The next line that is neither blank nor a comment, its blanks at both ends removed.
  [[nodiscard]] std::optional<std::string_view> next_filled(std::string_view comment_mark = "#");
  /// Of the line that was read last, from 1; 0 before the first.
  [[nodiscard]] int line() const { return line_; }
  /// How many bytes are left: no list in the file can be longer than that.
  [[nodiscard]] std::size_t bytes_left() const { return text_.size() - at_; }
  /// What follows the line that was read last: binary data behind a header of text.
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }
  /// That the line that was read last had its end. A text that was cut off in a number has none, and a shorter number
  /// there would be read as a value. Errors: InvalidInput.
  [[nodiscard]] Result<void> check_end() const;
  [[nodiscard]] const std::string& file() const { return file_; }

  /// InvalidInput at the line that was read last.
  [[nodiscard]] Error error(std::string field, std::string seen, std::string limit = {}) const;
  /// A finite number, all of `text`. Errors: InvalidInput.
  [[nodiscard]] Result<double> number(std::string_view text, std::string_view field) const;
  /// All of `text`, least to most. Errors: InvalidInput.
  [[nodiscard]] Result<std::size_t> whole(std::string_view text, std::string_view field, std::size_t least,
                                          std::size_t most) const;
  /// Numbers between blanks, exactly `count` of them. Errors: InvalidInput.
  [[nodiscard]] Result<std::vector<double>> numbers(std::string_view text, std::string_view field,
                                                    std::size_t count) const;

 private:
  std::string_view text_;
  std::string format_;
  std::string file_;
  std::size_t at_ = 0;
  int line_ = 0;
  bool ended_ = true;
};

[[nodiscard]] std::string_view trimmed(std::string_view text);
/// Between commas or the like: empty parts are kept.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);
/// Between runs of blanks and tabs: no part is empty.
[[nodiscard]] std::vector<std::string_view> words(std::string_view text);
/// The first word, and what follows it without blanks at both ends.
struct KeyAndRest {
  std::string_view key;
  std::string_view rest;
};
[[nodiscard]] KeyAndRest key_and_rest(std::string_view line);

/// As few digits as read back to the same double, whatever the locale.
[[nodiscard]] std::string number_text(double value);
/// A text for one line of a file: control characters become blanks.
[[nodiscard]] std::string one_line(std::string_view text);

}  // namespace gonio::formats
