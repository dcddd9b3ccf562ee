#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace gonio::test {

/// What a disk is asked for; each is one operation of the count.
enum class DiskOperation : std::uint8_t { Write, Sync, Truncate, Delete };

/// A disk below SQLite, for one process: every database that this process opens while it lives lies on it. Files are
/// real, so that readers see what a page cache would show; beside them it remembers what has reached the platter. A
/// power cut leaves of each file what was synced, and of each later write a random choice of its sectors, in any order;
/// truncations, creations and deletions that were not synced come about or do not. Throws std::runtime_error when its
/// own files fail. Threads: any; one disk at a time.
class PowerCutDisk {
 public:
  /// `keeps_its_word`: false is a disk that answers a sync at once and does nothing, as with PRAGMA synchronous = OFF.
  explicit PowerCutDisk(bool keeps_its_word = true);
  ~PowerCutDisk();
  PowerCutDisk(const PowerCutDisk&) = delete;
  PowerCutDisk& operator=(const PowerCutDisk&) = delete;

  /// Operations so far.
  [[nodiscard]] std::uint64_t operations() const;
  /// The power goes when the count reaches `operation`: that one is still begun (a sync is then done or not, a write
  /// pending), and it and everything after it fails.
  void cut_at(std::uint64_t operation);
  [[nodiscard]] bool is_cut() const;
  /// The files as the cut left them, `seed` choosing; the power is back. Close every database before.
  void restore(std::uint64_t seed);

  /// Operations of which `fails` is true get this SQLite result code (SQLITE_FULL, SQLITE_IOERR) and have no effect.
  /// An empty function ends it. `fails` is called with the kind and the file's path, under the disk's lock.
  void refuse(int code, std::function<bool(DiskOperation, const std::string&)> fails);

  /// Who waits for a lock does so without time passing; `meanwhile` happens at each such pause.
  void while_waiting(std::function<void()> meanwhile);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::test
