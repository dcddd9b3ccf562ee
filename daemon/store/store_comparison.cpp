#include "daemon/store/store_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <string_view>
#include <vector>

#include "daemon/store/database.h"

namespace gonio::daemon {
namespace {

// Durations that were asked for, or that a device said: no times of ours.
constexpr std::array<std::string_view, 8> kNoTimes{"exposure_ns",    "exposures_ns",  "max_time_ns",
                                                   "block_ns",       "dark_every_ns", "reference_every_ns",
                                                   "check_every_ns", "camera_time_ns"};
constexpr std::size_t kMostShown = 120;  // letters of a value in a sentence

bool is_a_time(std::string_view column) {
  return column.ends_with("_ns") && std::ranges::find(kNoTimes, column) == kNoTimes.end();
}

std::string shown(const std::string& value) {
  return value.size() <= kMostShown ? value : value.substr(0, kMostShown) + "...";
}

/// One store, with the texts of its statements, which must outlive them.
class Side {
 public:
  static Result<std::unique_ptr<Side>> open(const std::string& file) {
    Result<std::unique_ptr<Database>> database = Database::open(file, Database::Mode::Read);
    if (!database) return failure(std::move(database).error());
    return std::make_unique<Side>(std::move(*database));
  }
  explicit Side(std::unique_ptr<Database> database) : database_(std::move(database)) {}

  Statement& ask(std::string sql) { return database_->statement(texts_.emplace_back(std::move(sql)).c_str()); }
  std::vector<std::string> list(std::string sql) {
    std::vector<std::string> values;
    Statement& rows = ask(std::move(sql));
    while (rows.next()) values.push_back(rows.text(0));
    return values;
  }
  std::vector<std::string> tables() {
    return list("SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%' ORDER BY name");
  }
  std::vector<std::string> columns(const std::string& table) {
    return list(fmt::format("SELECT name FROM pragma_table_info('{}') ORDER BY cid", table));
  }
  // Each value as SQL would write it: exact for numbers, and of one kind of thing only.
  Statement& rows(const std::string& table, const std::vector<std::string>& columns) {
    std::string wanted;
    for (const std::string& column : columns) wanted += fmt::format("{}quote({})", wanted.empty() ? "" : ", ", column);
    std::string keys;
    for (const std::string& key :
         list(fmt::format("SELECT name FROM pragma_table_info('{}') WHERE pk > 0 ORDER BY pk", table))) {
      keys += keys.empty() ? key : ", " + key;
    }
    return ask(fmt::format("SELECT {} FROM {} ORDER BY {}", wanted, table, keys.empty() ? "rowid" : keys));
  }
  [[nodiscard]] Result<void> take_error() { return database_->take_error(); }

 private:
  std::deque<std::string> texts_;
  std::unique_ptr<Database> database_;
};

tl::unexpected<Error> differs(const std::string& where, const std::string& here, const std::string& there) {
  return failure({.code = ErrorCode::ReplayDiffers,
                  .device = "store",
                  .tried = "compare " + where,
                  .seen = shown(here),
                  .limit = shown(there) + ", as in the other store"});
}

Result<void> compare_row(const std::string& where, const std::vector<std::string>& columns, const Statement& here,
                         const Statement& there, StoreComparison& found) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::string mine = here.text(static_cast<int>(c));
    const std::string other = there.text(static_cast<int>(c));
    if (mine == other || columns[c] == "pid") continue;
    if (!is_a_time(columns[c])) return differs(where + ", column " + columns[c], mine, other);
    ++found.times_that_differ;
  }
  return {};
}

Result<void> compare_table(const std::string& table, Side& store, Side& against, StoreComparison& found) {
  const std::vector<std::string> columns = store.columns(table);
  if (columns != against.columns(table)) return differs("table " + table, "other columns", "its columns");
  Statement& here = store.rows(table, columns);
  Statement& there = against.rows(table, columns);
  for (std::int64_t row = 1;; ++row) {
    const std::string where = fmt::format("table {}, row {}", table, row);
    const bool is_here = here.next();
    const bool is_there = there.next();
    if (!is_here && !is_there) return {};
    if (!is_here) return differs(where, "no such row", columns[0] + " = " + there.text(0));
    if (!is_there) return differs(where, columns[0] + " = " + here.text(0), "no such row");
    GONIO_TRY(compare_row(where, columns, here, there, found));
    ++found.rows;
  }
}

}  // namespace

Result<StoreComparison> compare_stores(const std::string& store, const std::string& against) {
  const Result<std::unique_ptr<Side>> here = Side::open(store);
  if (!here) return failure(here.error());
  const Result<std::unique_ptr<Side>> there = Side::open(against);
  if (!there) return failure(there.error());
  StoreComparison found;
  const std::vector<std::string> tables = (*here)->tables();
  if (tables != (*there)->tables()) return differs("the tables", "others", "its tables");
  for (const std::string& table : tables) GONIO_TRY(compare_table(table, **here, **there, found));
  GONIO_TRY((*here)->take_error());
  GONIO_TRY((*there)->take_error());
  return found;
}

}  // namespace gonio::daemon
