#pragma once

#include <memory>
#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

struct StoreOptions {
  std::string path;
  std::string boot_id;  ///< /proc/sys/kernel/random/boot_id: intervals use boot time within one
  std::string version;  ///< of the daemon
};

/// The one writer of the store: an exclusive lock beside the file keeps a second daemon out. Threads: one.
class StoreWriter {
 public:
  /// Creates the file if it is not there, migrates it forward, records the run.
  /// Errors: StoreLocked (with the other's pid), StoreTooNew, StoreFailed, DiskFull. The clock must outlive the writer.
  [[nodiscard]] static Result<std::unique_ptr<StoreWriter>> open(const StoreOptions& options, const Clock& clock);
  virtual ~StoreWriter() = default;

  /// All of it durable, or nothing. Errors: StoreFailed (a doubled acceptance among them), DiskFull, InvalidInput (a
  /// number that is not finite).
  [[nodiscard]] virtual Result<CommitReceipt> commit(const StoreTransaction& transaction) = 0;
  /// What is not over, oldest first, as this writer sees it.
  [[nodiscard]] virtual Result<std::vector<UnfinishedScan>> unfinished() = 0;
};

}  // namespace gonio::daemon
