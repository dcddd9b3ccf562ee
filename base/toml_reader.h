#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace gonio {

/// The values that a number may take, both ends included. `unit` is only for messages.
struct NumberRange {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  std::string_view unit{};
};

enum class TomlKind : std::uint8_t { Absent, Number, Text, Flag, Array, Table, Date };

/// One table of a TOML text, read strictly: a key that nobody asked for, a wrong type, a value outside its range is an
/// error with file, line and field, and with the nearest name that would have been known.
///
/// The first error sticks: accessors after it return harmless values, and `finish` on the root gives it back. So a
/// configuration is read straight through and checked once. Copies share their document. NaN and infinity are refused.
/// Threads: one. The foreign parser stays inside toml_reader.cpp.
class TomlReader {
 public:
  /// Errors: InvalidInput (not TOML; with the line). `file` is the name shown in errors: the user's, never opened here.
  [[nodiscard]] static Result<TomlReader> parse(std::string_view text, std::string file);
  /// Errors: FileUnreadable, InvalidInput.
  [[nodiscard]] static Result<TomlReader> parse_file(const std::string& path);

  double number(std::string_view key, NumberRange range = {});
  double number_or(std::string_view key, double fallback, NumberRange range = {});
  std::optional<double> optional_number(std::string_view key, NumberRange range = {});
  std::int64_t integer(std::string_view key, std::int64_t least, std::int64_t most);
  std::int64_t integer_or(std::string_view key, std::int64_t fallback, std::int64_t least, std::int64_t most);
  std::string text(std::string_view key);
  std::string text_or(std::string_view key, std::string_view fallback);
  bool flag_or(std::string_view key, bool fallback);
  /// An index into `choices`.
  std::size_t choice(std::string_view key, std::span<const std::string_view> choices);
  std::size_t choice_or(std::string_view key, std::size_t fallback, std::span<const std::string_view> choices);
  /// Never empty unless an error stuck.
  std::vector<double> numbers(std::string_view key, NumberRange range = {});
  std::vector<std::string> texts(std::string_view key);
  /// A TOML local date as "YYYY-MM-DD".
  std::string date(std::string_view key);

  TomlReader table(std::string_view key);
  std::optional<TomlReader> optional_table(std::string_view key);
  /// An array of tables ([[key]]), in the order of the text; empty when absent.
  std::vector<TomlReader> tables(std::string_view key);

  [[nodiscard]] TomlKind kind(std::string_view key);
  /// All keys of this table, in the order of the text. Asking marks none of them as known.
  [[nodiscard]] std::vector<std::string> keys() const;
  [[nodiscard]] InputLocation location(std::string_view key) const;
  [[nodiscard]] const std::string& file() const;

  /// For checks that only the caller can make: records an error at `key` unless one stuck before.
  void fail(std::string_view key, ErrorCode code, std::string seen, std::string limit = {});
  [[nodiscard]] bool has_failed() const;

  /// The first error of the whole document, or the first key that nobody asked for. Call once, when all is read.
  [[nodiscard]] Result<void> finish() const;

 private:
  struct Document;
  struct Access;
  TomlReader(std::shared_ptr<Document> document, const void* table, std::string path);
  std::shared_ptr<Document> document_;
  const void* table_;  ///< a table of the document; null after an error
  std::string path_;   ///< "geometry.theta_r_deg"
};

}  // namespace gonio
