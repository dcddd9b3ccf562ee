#include "tests/scenario/store_copy.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace gonio::test {
namespace {

std::string copied(const std::string& store, const std::string& folder) {
  namespace fs = std::filesystem;
  const std::string copy = folder + "/copy.sqlite";
  for (const char* ending : {"", "-wal", "-shm"}) {
    fs::remove(copy + ending);
    // The shared memory is not copied: the journal alone says what was committed.
    if (std::string(ending) != "-shm" && fs::exists(store + ending)) fs::copy_file(store + ending, copy + ending);
  }
  return copy;
}

// Text of a column that keeps every bit.
std::string exact(const SQLite::Column& column) {
  if (column.isFloat()) return std::to_string(std::bit_cast<std::uint64_t>(column.getDouble()));
  return column.isNull() ? "-" : column.getString();
}

std::string exact_row(SQLite::Statement& row) {
  std::string text;
  for (int i = 0; i < row.getColumnCount(); ++i) text += exact(row.getColumn(i)) + '|';
  return text + '\n';
}

std::string item_name(SQLite::Statement& row) {
  return row.getColumn("point_index").getString() + ' ' + row.getColumn("target").getString();
}

}  // namespace

struct StoreCopy::Database {
  explicit Database(const std::string& file) : sqlite(file, SQLite::OPEN_READWRITE) {}
  SQLite::Database sqlite;
};

StoreCopy::StoreCopy(const std::string& store, const std::string& folder)
    : database_(std::make_unique<Database>(copied(store, folder))) {}

StoreCopy::~StoreCopy() = default;

std::string StoreCopy::integrity() const {
  return database_->sqlite.execAndGet("PRAGMA integrity_check").getString();
}

std::vector<long> StoreCopy::event_numbers() const {
  std::vector<long> numbers;
  SQLite::Statement rows(database_->sqlite, "SELECT number FROM event ORDER BY number");
  while (rows.executeStep()) numbers.push_back(rows.getColumn(0).getInt64());
  return numbers;
}

long StoreCopy::count(const std::string& from) const {
  return database_->sqlite.execAndGet("SELECT COUNT(*) FROM " + from).getInt64();
}

std::map<std::string, std::string> StoreCopy::accepted_items() const {
  std::map<std::string, std::string> items;
  SQLite::Statement attempts(database_->sqlite,
                             "SELECT attempt.* FROM decided_item i JOIN attempt USING (attempt_id) "
                             "WHERE i.outcome = 'accepted'");
  while (attempts.executeStep()) items[item_name(attempts)] += exact_row(attempts);
  SQLite::Statement readings(database_->sqlite,
                             "SELECT attempt.point_index AS point_index, attempt.target AS target, reading.* "
                             "FROM decided_item i JOIN attempt USING (attempt_id) JOIN reading USING (attempt_id) "
                             "WHERE i.outcome = 'accepted' ORDER BY reading.attempt_id, reading.sequence");
  while (readings.executeStep()) items[item_name(readings)] += exact_row(readings);
  return items;
}

std::map<std::string, long> StoreCopy::exposures() const {
  std::map<std::string, long> counts;
  SQLite::Statement rows(database_->sqlite,
                         "SELECT attempt.point_index || ' ' || attempt.target, COUNT(*) FROM reading "
                         "LEFT JOIN attempt USING (attempt_id) GROUP BY 1");
  while (rows.executeStep()) {
    const SQLite::Column item = rows.getColumn(0);
    counts[item.isNull() ? "dark" : item.getString()] += rows.getColumn(1).getInt64();
  }
  return counts;
}

std::map<long, StoredPoint> StoreCopy::points(long scan) const {
  std::map<long, StoredPoint> points;
  SQLite::Statement rows(database_->sqlite,
                         "SELECT point_index, theta_i_deg, theta_r_deg, phi_r_deg FROM point WHERE scan_id = ?");
  rows.bind(1, static_cast<std::int64_t>(scan));
  while (rows.executeStep()) {
    points[rows.getColumn(0).getInt64()] = {.theta_i_deg = rows.getColumn(1).getDouble(),
                                            .theta_r_deg = rows.getColumn(2).getDouble(),
                                            .phi_r_deg = rows.getColumn(3).getDouble()};
  }
  return points;
}

std::map<long, StoredValue> StoreCopy::brdf(long scan) const {
  SQLite::Statement newest(database_->sqlite,
                           "SELECT calibration_id, component_names_json FROM calibration WHERE scan_id = ? "
                           "ORDER BY calibration_id DESC LIMIT 1");
  newest.bind(1, static_cast<std::int64_t>(scan));
  std::map<long, StoredValue> values;
  if (!newest.executeStep()) return values;
  const auto names = nlohmann::json::parse(newest.getColumn(1).getString()).get<std::vector<std::string>>();
  SQLite::Statement rows(database_->sqlite,
                         "SELECT point_index, value_per_sr, u_random_per_sr, sensitivities_per_sr FROM brdf "
                         "WHERE calibration_id = ?");
  rows.bind(1, newest.getColumn(0).getInt64());
  while (rows.executeStep()) {
    StoredValue& value = values[rows.getColumn(0).getInt64()];
    value.value = rows.getColumn(1).getDouble();
    value.u_random = rows.getColumn(2).getDouble();
    const SQLite::Column blob = rows.getColumn(3);
    std::vector<double> pairs(static_cast<std::size_t>(blob.getBytes()) / sizeof(double));
    std::memcpy(pairs.data(), blob.getBlob(), pairs.size() * sizeof(double));
    for (std::size_t k = 0; k + 1 < pairs.size(); k += 2) {
      value.shared[names.at(static_cast<std::size_t>(pairs[k]))] = pairs[k + 1];  // (component, sensitivity)
    }
  }
  return values;
}

}  // namespace gonio::test
