#include "daemon/store/store_writer.h"

#include <fmt/core.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/store/database.h"
#include "daemon/store/record_writer.h"
#include "daemon/store/schema.h"
#include "daemon/store/store_lock.h"
#include "daemon/store/unfinished_scans.h"

namespace gonio::daemon {

namespace {

// NTP slews by less than this between two transactions; more is somebody setting the clock.
constexpr Duration kClockStep = std::chrono::seconds(1);

class SqliteStoreWriter final : public StoreWriter {
 public:
  SqliteStoreWriter(StoreLock lock, std::unique_ptr<Database> database, const Clock& clock)
      : lock_(std::move(lock)), database_(std::move(database)), clock_(clock), utc_ahead_(utc_ahead()) {}

  ~SqliteStoreWriter() override {
    database_->execute("PRAGMA wal_checkpoint(TRUNCATE)");  // the next start finds one file; nothing depends on it
  }

  Result<void> begin_run(const StoreOptions& options) {
    Statement& last = database_->statement("SELECT coalesce(max(number), 0) FROM event");
    while (last.next()) last_event_ = last.integer(0);
    database_->execute("BEGIN IMMEDIATE");
    const Instant now = clock_.now();
    database_
        ->statement("INSERT INTO run(boot_id, version, pid, started_utc_ns, started_boottime_ns) VALUES (?,?,?,?,?)")
        .bind(options.boot_id)
        .bind(options.version)
        .bind(static_cast<std::int64_t>(getpid()))
        .bind(clock_.utc_now().time_since_epoch().count())
        .bind(now.time_since_epoch().count())
        .run();
    run_ = database_->last_id();
    RecordWriter writer(*database_, write_time(now));
    (void)writer.write_event({.kind = "run-started",
                              .who = "goniod",
                              .json = nlohmann::json{{"run", run_}, {"version", options.version}}.dump()},
                             last_event_ + 1);
    GONIO_TRY(commit_or_roll_back());
    ++last_event_;
    return {};
  }

  Result<CommitReceipt> commit(const StoreTransaction& transaction) override {
    CommitReceipt receipt;
    receipt.new_scan = scan_of_known_key(transaction);
    GONIO_TRY(database_->take_error());
    receipt.existed = receipt.new_scan != 0;
    if (receipt.existed) return receipt;

    RecordWriter writer(*database_, write_time(transaction.at));
    database_->statement("BEGIN IMMEDIATE").run();
    for (const StoreWrite& write : transaction.writes) std::visit(writer, write);
    std::int64_t number = last_event_;
    for (const NewEvent& event : transaction.events) receipt.events.push_back(writer.write_event(event, ++number));
    if (const auto step = clock_step()) receipt.events.push_back(writer.write_event(*step, ++number));
    GONIO_TRY(commit_or_roll_back());
    last_event_ = number;
    utc_ahead_ = utc_ahead();
    receipt.new_scan = writer.new_scan();
    return receipt;
  }

  Result<std::vector<UnfinishedScan>> unfinished() override {
    auto scans = read_unfinished(*database_, clock_.now(), clock_.utc_now());
    GONIO_TRY(database_->take_error());
    return scans;
  }

 private:
  [[nodiscard]] Duration utc_ahead() const {
    return clock_.utc_now().time_since_epoch() - clock_.now().time_since_epoch();
  }

  [[nodiscard]] WriteTime write_time(Instant at) const {
    const std::int64_t boottime_ns = at.time_since_epoch().count();
    return {.run = run_, .boottime_ns = boottime_ns, .utc_ns = boottime_ns + utc_ahead().count()};
  }

  [[nodiscard]] std::optional<NewEvent> clock_step() const {
    const Duration step = utc_ahead() - utc_ahead_;
    if (step < kClockStep && step > -kClockStep) return std::nullopt;
    return NewEvent{
        .kind = "clock-stepped", .who = "goniod", .json = nlohmann::json{{"step_s", in_seconds(step)}}.dump()};
  }

  ScanId scan_of_known_key(const StoreTransaction& transaction) {
    ScanId known = 0;
    for (const StoreWrite& write : transaction.writes) {
      const auto* scan = std::get_if<NewScan>(&write);
      if (scan == nullptr || scan->idempotency_key.empty()) continue;
      Statement& query =
          database_->statement("SELECT scan_id FROM scan WHERE idempotency_key = ?").bind(scan->idempotency_key);
      while (query.next()) known = query.integer(0);
    }
    return known;
  }

  Result<void> commit_or_roll_back() {
    database_->statement("COMMIT").run();
    auto done = database_->take_error();
    if (done) return done;
    database_->execute("ROLLBACK");
    (void)database_->take_error();  // SQLite has rolled back by itself after some errors
    return done;
  }

  StoreLock lock_;
  std::unique_ptr<Database> database_;
  const Clock& clock_;
  Duration utc_ahead_;
  std::int64_t run_ = 0;
  std::int64_t last_event_ = 0;
};

}  // namespace

Result<std::unique_ptr<StoreWriter>> StoreWriter::open(const StoreOptions& options, const Clock& clock) {
  auto lock = StoreLock::take(options.path);
  if (!lock) return failure(lock.error());
  auto database = Database::open(options.path, Database::Mode::Write);
  if (!database) return failure(database.error());
  // FULL: a commit that returned survives a power cut. The checkpoint's size bounds the WAL of a long scan.
  (*database)->execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
  GONIO_TRY((*database)->take_error());
  GONIO_TRY(migrate(**database));
  auto writer = std::make_unique<SqliteStoreWriter>(std::move(*lock), std::move(*database), clock);
  GONIO_TRY(writer->begin_run(options));
  return writer;
}

}  // namespace gonio::daemon
