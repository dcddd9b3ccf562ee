#include "daemon/store/database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/core.h>
#include <sqlite3.h>

#include <cmath>
#include <unordered_map>
#include <utility>

namespace gonio::daemon {

namespace {

// A reader may meet the writer's checkpoint, a writer a reader's lock: both are over in milliseconds.
constexpr int kBusyTimeoutMs = 5000;

Error store_error(const SQLite::Exception& exception, std::string tried) {
  const int code = exception.getErrorCode();
  return Error{.code = code == SQLITE_FULL ? ErrorCode::DiskFull : ErrorCode::StoreFailed,
               .device = "store",
               .tried = std::move(tried),
               .seen = fmt::format("{} (SQLite {})", exception.what(), exception.getExtendedErrorCode())};
}

}  // namespace

struct Statement::Impl {
  Impl(Database& db, const char* sql, const SQLite::Database& connection) : database(db), statement(connection, sql) {}

  template <class Action>
  void guarded(Action action) {
    if (database.has_failed()) return;
    try {
      action();
    } catch (const SQLite::Exception& exception) {
      database.fail(store_error(exception, statement.getQuery()));
    }
  }

  void make_ready() {
    statement.tryReset();
    bound = 0;
  }

  Database& database;
  SQLite::Statement statement;
  int bound = 0;
};

struct Database::Impl {
  explicit Impl(const std::string& path, int flags) : connection(path, flags, kBusyTimeoutMs) {}

  SQLite::Database connection;
  std::unordered_map<const char*, std::unique_ptr<Statement>> statements;
};

Statement::Statement(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Statement::~Statement() = default;

Statement& Statement::bind(std::int64_t value) {
  impl_->guarded([&] { impl_->statement.bind(++impl_->bound, value); });
  return *this;
}

Statement& Statement::bind(double value) {
  if (!std::isfinite(value)) {
    impl_->database.fail(
        Error{.code = ErrorCode::InvalidInput,
              .device = "store",
              .tried = fmt::format("write value {} of: {}", impl_->bound + 1, impl_->statement.getQuery()),
              .seen = fmt::format("{}", value),
              .limit = "a finite number"});
  }
  impl_->guarded([&] { impl_->statement.bind(++impl_->bound, value); });
  return *this;
}

Statement& Statement::bind(std::string_view value) {
  impl_->guarded([&] { impl_->statement.bind(++impl_->bound, std::string(value)); });
  return *this;
}

Statement& Statement::bind_blob(std::span<const double> values) {
  for (const double value : values) {
    if (std::isfinite(value)) continue;
    impl_->database.fail(Error{.code = ErrorCode::InvalidInput,
                               .device = "store",
                               .tried = "write a list of numbers",
                               .seen = fmt::format("{}", value),
                               .limit = "finite numbers"});
  }
  impl_->guarded([&] { impl_->statement.bind(++impl_->bound, values.data(), static_cast<int>(values.size_bytes())); });
  return *this;
}

Statement& Statement::bind_null() {
  impl_->guarded([&] { impl_->statement.bind(++impl_->bound); });
  return *this;
}

void Statement::run() {
  impl_->guarded([&] { impl_->statement.exec(); });
  impl_->make_ready();
}

bool Statement::next() {
  bool has_row = false;
  impl_->guarded([&] { has_row = impl_->statement.executeStep(); });
  if (!has_row) impl_->make_ready();
  return has_row;
}

std::int64_t Statement::integer(int column) const {
  return impl_->statement.getColumn(column).getInt64();
}
double Statement::real(int column) const {
  return impl_->statement.getColumn(column).getDouble();
}
std::string Statement::text(int column) const {
  return impl_->statement.getColumn(column).getString();
}
bool Statement::is_null(int column) const {
  return impl_->statement.getColumn(column).isNull();
}

std::span<const double> Statement::doubles(int column) const {
  const SQLite::Column blob = impl_->statement.getColumn(column);
  return {static_cast<const double*>(blob.getBlob()), static_cast<std::size_t>(blob.getBytes()) / sizeof(double)};
}

Database::Database(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Database::~Database() = default;

Result<std::unique_ptr<Database>> Database::open(const std::string& path, Mode mode) {
  const int flags = mode == Mode::Write ? SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE : SQLite::OPEN_READONLY;
  try {
    return std::unique_ptr<Database>(new Database(std::make_unique<Impl>(path, flags)));
  } catch (const SQLite::Exception& exception) {
    return failure(store_error(exception, "open " + path));
  }
}

Statement& Database::statement(const char* sql) {
  auto& kept = impl_->statements[sql];
  if (kept) return *kept;
  try {
    kept.reset(new Statement(std::make_unique<Statement::Impl>(*this, sql, impl_->connection)));
  } catch (const SQLite::Exception& exception) {
    fail(store_error(exception, sql));
    static constexpr const char* kNothing = "SELECT 0 WHERE 0";  // takes the calls that follow; the error stands
    return statement(kNothing);
  }
  return *kept;
}

void Database::execute(const char* sql) {
  if (has_failed()) return;
  try {
    impl_->connection.exec(sql);
  } catch (const SQLite::Exception& exception) {
    fail(store_error(exception, std::string(sql).substr(0, 60)));
  }
}

std::int64_t Database::last_id() const {
  return impl_->connection.getLastInsertRowid();
}

Result<void> Database::take_error() {
  if (!error_) return {};
  Error error = std::move(*error_);
  error_.reset();
  return failure(std::move(error));
}

void Database::fail(Error error) {
  if (!error_) error_ = std::move(error);
}

}  // namespace gonio::daemon
