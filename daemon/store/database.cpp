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

Error store_error(int code, int extended_code, const char* message, std::string tried) {
  return Error{.code = code == SQLITE_FULL ? ErrorCode::DiskFull : ErrorCode::StoreFailed,
               .device = "store",
               .tried = std::move(tried),
               .seen = fmt::format("{} (SQLite {})", message, extended_code)};
}

Error store_error(const SQLite::Exception& exception, std::string tried) {
  return store_error(exception.getErrorCode(), exception.getExtendedErrorCode(), exception.what(), std::move(tried));
}

}  // namespace

// By SQLite's own functions: a scan of a million points is some 10^8 values, and for each SQLiteCpp makes an object
// that shares the statement.
struct Statement::Impl {
  Impl(Database& db, const char* text, sqlite3* handle) : database(db), connection(handle), sql(text) {
    check(sqlite3_prepare_v3(connection, sql, -1, SQLITE_PREPARE_PERSISTENT, &statement, nullptr));
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { sqlite3_finalize(statement); }

  void check(int code) {
    if (code == SQLITE_OK) return;
    database.fail(store_error(code & 0xFF, sqlite3_extended_errcode(connection), sqlite3_errmsg(connection), sql));
  }
  template <class Bind>
  void bind_next(const Bind& bind) {
    if (!database.has_failed()) check(bind(++bound));
  }
  // Whether there is a row.
  bool step() {
    if (database.has_failed()) return false;
    const int code = sqlite3_step(statement);
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) check(code);
    return false;
  }
  void make_ready() {
    sqlite3_reset(statement);  // its code is that of the step, which has been checked
    bound = 0;
  }

  Database& database;
  sqlite3* connection;
  const char* sql;
  sqlite3_stmt* statement = nullptr;
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
  impl_->bind_next([&](int place) { return sqlite3_bind_int64(impl_->statement, place, value); });
  return *this;
}

Statement& Statement::bind(double value) {
  if (!std::isfinite(value)) {
    impl_->database.fail(Error{.code = ErrorCode::InvalidInput,
                               .device = "store",
                               .tried = fmt::format("write value {} of: {}", impl_->bound + 1, impl_->sql),
                               .seen = fmt::format("{}", value),
                               .limit = "a finite number"});
  }
  impl_->bind_next([&](int place) { return sqlite3_bind_double(impl_->statement, place, value); });
  return *this;
}

Statement& Statement::bind(std::string_view value) {
  const char* text = value.data() == nullptr ? "" : value.data();  // null would be NULL
  impl_->bind_next([&](int place) {
    return sqlite3_bind_text(impl_->statement, place, text, static_cast<int>(value.size()), SQLITE_TRANSIENT);
  });
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
  impl_->bind_next([&](int place) {
    if (values.empty()) return sqlite3_bind_zeroblob(impl_->statement, place, 0);
    return sqlite3_bind_blob(impl_->statement, place, values.data(), static_cast<int>(values.size_bytes()),
                             SQLITE_TRANSIENT);
  });
  return *this;
}

Statement& Statement::bind_null() {
  impl_->bind_next([&](int place) { return sqlite3_bind_null(impl_->statement, place); });
  return *this;
}

void Statement::run() {
  if (impl_->step()) {
    impl_->database.fail(store_error(SQLITE_MISUSE, SQLITE_MISUSE, "it gives rows", impl_->sql));
  }
  impl_->make_ready();
}

bool Statement::next() {
  const bool has_row = impl_->step();
  if (!has_row) impl_->make_ready();
  return has_row;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(impl_->statement, column);
}
double Statement::real(int column) const {
  return sqlite3_column_double(impl_->statement, column);
}
std::string Statement::text(int column) const {
  const void* bytes = sqlite3_column_blob(impl_->statement, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(impl_->statement, column));
  return size == 0 ? std::string() : std::string(static_cast<const char*>(bytes), size);
}
bool Statement::is_null(int column) const {
  return sqlite3_column_type(impl_->statement, column) == SQLITE_NULL;
}

std::span<const double> Statement::doubles(int column) const {
  const void* bytes = sqlite3_column_blob(impl_->statement, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(impl_->statement, column));
  return {static_cast<const double*>(bytes), size / sizeof(double)};
}

Database::Database(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Database::~Database() = default;

Result<std::unique_ptr<Database>> Database::open(const std::string& path, Mode mode) {
  const int access = mode == Mode::Write ? SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE : SQLite::OPEN_READONLY;
  const int flags = access | SQLite::OPEN_NOMUTEX;  // a connection is one thread's at a time
  try {
    return std::unique_ptr<Database>(new Database(std::make_unique<Impl>(path, flags)));
  } catch (const SQLite::Exception& exception) {
    return failure(store_error(exception, "open " + path));
  }
}

Statement& Database::statement(const char* sql) {
  auto& kept = impl_->statements[sql];
  if (kept) return *kept;
  auto made = std::make_unique<Statement::Impl>(*this, sql, impl_->connection.getHandle());
  if (made->statement == nullptr) {
    static constexpr const char* kNothing = "SELECT 0 WHERE 0";  // takes the calls that follow; the error stands
    return statement(kNothing);
  }
  kept.reset(new Statement(std::move(made)));
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
