#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/result.h"

namespace gonio::daemon {

class Database;

/// One prepared statement. Values are bound from the first parameter on; after an error all calls do nothing.
/// Threads: its database's.
class Statement {
 public:
  Statement& bind(std::int64_t value);
  Statement& bind(int value) { return bind(static_cast<std::int64_t>(value)); }
  Statement& bind(std::uint32_t value) { return bind(static_cast<std::int64_t>(value)); }
  Statement& bind(bool value) { return bind(static_cast<std::int64_t>(value ? 1 : 0)); }
  /// Refuses what is not finite: SQLite would store NaN as NULL, and nobody would know.
  Statement& bind(double value);
  Statement& bind(std::string_view value);
  Statement& bind(const char* value) { return bind(std::string_view(value)); }
  Statement& bind(const std::string& value) { return bind(std::string_view(value)); }
  Statement& bind_blob(std::span<const double> values);
  Statement& bind_null();

  /// Executes a statement that gives no rows, and makes it ready for the next binding.
  void run();
  /// Steps to the next row; false at the end (then ready for the next binding) and after an error.
  [[nodiscard]] bool next();

  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] bool is_null(int column) const;
  [[nodiscard]] std::span<const double> doubles(int column) const;  ///< until the next step

  ~Statement();

 private:
  friend class Database;
  struct Impl;
  explicit Statement(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// One connection to the store's file. The first error sticks until it is taken, and nothing is done meanwhile: SQL is
/// written straight through and checked once, at the end. The foreign library stays inside database.cpp. Threads: one
/// at a time.
class Database {
 public:
  enum class Mode : std::uint8_t { Write, Read };

  /// Errors: StoreFailed, DiskFull. `Write` creates the file.
  [[nodiscard]] static Result<std::unique_ptr<Database>> open(const std::string& path, Mode mode);
  ~Database();

  /// The statement of this text, prepared at its first use and kept; `sql` must live as long as the database.
  Statement& statement(const char* sql);
  /// Several statements at once, without parameters.
  void execute(const char* sql);
  [[nodiscard]] std::int64_t last_id() const;

  [[nodiscard]] bool has_failed() const { return error_.has_value(); }
  /// The first error since the last call, if there was one; the database can be used again.
  [[nodiscard]] Result<void> take_error();
  void fail(Error error);

 private:
  friend class Statement;
  struct Impl;
  explicit Database(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
  std::optional<Error> error_;
};

}  // namespace gonio::daemon
