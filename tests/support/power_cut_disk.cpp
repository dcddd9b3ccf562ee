#include "tests/support/power_cut_disk.h"

#include <sqlite3.h>

#include <filesystem>
#include <mutex>
#include <random>
#include <stdexcept>
#include <utility>

#include "tests/support/platters.h"

namespace gonio::test {
namespace {

struct DiskState {
  sqlite3_vfs vfs{};
  sqlite3_vfs* below = nullptr;
  bool keeps_its_word = true;
  mutable std::mutex mutex;
  Platters platters;
  std::uint64_t operations = 0;
  std::uint64_t cut_at = UINT64_MAX;
  bool is_cut = false;
  std::string sync_in_doubt;  ///< the file whose sync the cut came into
  std::string database;       ///< the last main file: its shared memory goes with the power
  int refusal = SQLITE_OK;
  std::function<bool(DiskOperation, const std::string&)> refuses;
  std::function<void()> meanwhile;

  enum class Fate : std::uint8_t { Done, Begun, Refused };
  Fate fate_of(DiskOperation operation, const std::string& path) {
    if (is_cut) return Fate::Refused;
    ++operations;
    if (refuses && refuses(operation, path)) return Fate::Refused;
    is_cut = operations >= cut_at;
    return is_cut ? Fate::Begun : Fate::Done;
  }
  [[nodiscard]] int refusal_code() const { return is_cut ? SQLITE_IOERR : refusal; }
};

/// A file of the VFS below, as SQLite allocates it: the other one's structure follows this one.
struct DiskFile {
  sqlite3_file base;
  DiskState* disk;
  std::string* path;  ///< null: a temporary file, which no power cut concerns
  bool syncs_its_directory;
};

DiskFile& of(sqlite3_file* file) {
  return *reinterpret_cast<DiskFile*>(file);
}
sqlite3_file* below(sqlite3_file* file) {
  return reinterpret_cast<sqlite3_file*>(&of(file) + 1);
}

int close_file(sqlite3_file* file) {
  const int code = below(file)->pMethods == nullptr ? SQLITE_OK : below(file)->pMethods->xClose(below(file));
  delete std::exchange(of(file).path, nullptr);
  return code;
}

int read_file(sqlite3_file* file, void* to, int n, sqlite3_int64 at) {
  return below(file)->pMethods->xRead(below(file), to, n, at);
}

// Counts the operation, lets `real` act on the files that everyone sees, and `note` on what a cut will leave.
template <class Real, class Note>
int operate(sqlite3_file* file, DiskOperation operation, Real real, Note note) {
  if (of(file).path == nullptr) return real();
  DiskState& disk = *of(file).disk;
  const std::lock_guard lock(disk.mutex);
  const auto fate = disk.fate_of(operation, *of(file).path);
  if (fate == DiskState::Fate::Refused) return disk.refusal_code();
  note(disk);
  return fate == DiskState::Fate::Begun ? SQLITE_IOERR : real();
}

int write_file(sqlite3_file* file, const void* from, int n, sqlite3_int64 at) {
  return operate(
      file, DiskOperation::Write, [&] { return below(file)->pMethods->xWrite(below(file), from, n, at); },
      [&](DiskState& disk) {
        disk.platters.write(*of(file).path, static_cast<std::size_t>(at), static_cast<const char*>(from),
                            static_cast<std::size_t>(n));
      });
}

int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
  return operate(
      file, DiskOperation::Truncate, [&] { return below(file)->pMethods->xTruncate(below(file), size); },
      [&](DiskState& disk) { disk.platters.truncate(*of(file).path, static_cast<std::size_t>(size)); });
}

// The real file lies where no power cut comes: what it would take to sync it is saved.
int sync_file(sqlite3_file* file, int) {
  return operate(
      file, DiskOperation::Sync, [] { return SQLITE_OK; },
      [&](DiskState& disk) {
        if (!disk.keeps_its_word) return;
        if (disk.is_cut) {
          disk.sync_in_doubt = *of(file).path;
          return;
        }
        disk.platters.sync_file(*of(file).path);
        if (std::exchange(of(file).syncs_its_directory, false)) disk.platters.sync_directory(*of(file).path);
      });
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
  return below(file)->pMethods->xFileSize(below(file), size);
}
int lock_file(sqlite3_file* file, int level) {
  return below(file)->pMethods->xLock(below(file), level);
}
int unlock_file(sqlite3_file* file, int level) {
  return below(file)->pMethods->xUnlock(below(file), level);
}
int check_reserved_lock(sqlite3_file* file, int* is_taken) {
  return below(file)->pMethods->xCheckReservedLock(below(file), is_taken);
}
int control_file(sqlite3_file* file, int what, void* argument) {
  return below(file)->pMethods->xFileControl(below(file), what, argument);
}
int sector_size(sqlite3_file* file) {
  return below(file)->pMethods->xSectorSize(below(file));
}
int characteristics(sqlite3_file* file) {
  return below(file)->pMethods->xDeviceCharacteristics(below(file));
}
int map_shared(sqlite3_file* file, int page, int size, int extend, void volatile** at) {
  return below(file)->pMethods->xShmMap(below(file), page, size, extend, at);
}
int lock_shared(sqlite3_file* file, int offset, int n, int flags) {
  return below(file)->pMethods->xShmLock(below(file), offset, n, flags);
}
void barrier(sqlite3_file* file) {
  below(file)->pMethods->xShmBarrier(below(file));
}
int unmap_shared(sqlite3_file* file, int deletes) {
  return below(file)->pMethods->xShmUnmap(below(file), deletes);
}

constexpr sqlite3_io_methods kMethods{.iVersion = 2,
                                      .xClose = close_file,
                                      .xRead = read_file,
                                      .xWrite = write_file,
                                      .xTruncate = truncate_file,
                                      .xSync = sync_file,
                                      .xFileSize = file_size,
                                      .xLock = lock_file,
                                      .xUnlock = unlock_file,
                                      .xCheckReservedLock = check_reserved_lock,
                                      .xFileControl = control_file,
                                      .xSectorSize = sector_size,
                                      .xDeviceCharacteristics = characteristics,
                                      .xShmMap = map_shared,
                                      .xShmLock = lock_shared,
                                      .xShmBarrier = barrier,
                                      .xShmUnmap = unmap_shared,
                                      .xFetch = nullptr,
                                      .xUnfetch = nullptr};

DiskState& disk_of(sqlite3_vfs* vfs) {
  return *static_cast<DiskState*>(vfs->pAppData);
}

int open_file(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  constexpr int kJournals = SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_WAL;
  DiskState& disk = disk_of(vfs);
  const bool is_ours = name != nullptr && (flags & (SQLITE_OPEN_MAIN_DB | kJournals)) != 0;
  of(file) = {.base = {}, .disk = &disk, .path = nullptr, .syncs_its_directory = false};
  const std::lock_guard lock(disk.mutex);
  const bool is_new = is_ours && !std::filesystem::exists(name);
  if (is_new && disk.is_cut) return SQLITE_CANTOPEN;
  const int code = disk.below->xOpen(disk.below, name, below(file), flags, out_flags);
  if (code != SQLITE_OK) return code;
  of(file).base.pMethods = &kMethods;
  if (!is_ours) return code;
  of(file).path = new std::string(name);
  if ((flags & SQLITE_OPEN_MAIN_DB) != 0) disk.database = name;
  // As SQLite's own VFS: the first sync of a new journal syncs the directory too, that of a database does not.
  of(file).syncs_its_directory = is_new && (flags & kJournals) != 0;
  if (is_new) disk.platters.create(name);
  return code;
}

int delete_file(sqlite3_vfs* vfs, const char* name, int syncs_directory) {
  DiskState& disk = disk_of(vfs);
  const std::lock_guard lock(disk.mutex);
  const auto fate = disk.fate_of(DiskOperation::Delete, name);
  if (fate == DiskState::Fate::Refused) return disk.refusal_code();
  if (std::filesystem::exists(name)) disk.platters.remove(name);
  if (fate == DiskState::Fate::Begun) return SQLITE_IOERR;
  if (syncs_directory != 0 && disk.keeps_its_word) disk.platters.sync_directory(name);
  return disk.below->xDelete(disk.below, name, 0);
}

int pause(sqlite3_vfs* vfs, int microseconds) {
  const auto& meanwhile = disk_of(vfs).meanwhile;
  if (meanwhile) meanwhile();
  return microseconds;
}

}  // namespace

struct PowerCutDisk::Impl : DiskState {};

PowerCutDisk::PowerCutDisk(bool keeps_its_word) : impl_(std::make_unique<Impl>()) {
  impl_->below = sqlite3_vfs_find(nullptr);
  if (impl_->below == nullptr) throw std::runtime_error("SQLite has no file system");
  impl_->keeps_its_word = keeps_its_word;
  impl_->vfs = *impl_->below;  // what is not replaced needs nothing of this one
  impl_->vfs.zName = "gonio-power-cut";
  impl_->vfs.pNext = nullptr;
  impl_->vfs.szOsFile = static_cast<int>(sizeof(DiskFile)) + impl_->below->szOsFile;
  impl_->vfs.pAppData = static_cast<DiskState*>(impl_.get());
  impl_->vfs.xOpen = open_file;
  impl_->vfs.xDelete = delete_file;
  impl_->vfs.xSleep = pause;
  sqlite3_vfs_register(&impl_->vfs, 1);
}

PowerCutDisk::~PowerCutDisk() {
  sqlite3_vfs_unregister(&impl_->vfs);
}

std::uint64_t PowerCutDisk::operations() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->operations;
}

void PowerCutDisk::cut_at(std::uint64_t operation) {
  const std::lock_guard lock(impl_->mutex);
  impl_->cut_at = operation;
}

bool PowerCutDisk::is_cut() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->is_cut;
}

void PowerCutDisk::restore(std::uint64_t seed) {
  const std::lock_guard lock(impl_->mutex);
  std::mt19937_64 chance(seed);
  if (!impl_->sync_in_doubt.empty() && chance() % 2 == 0) impl_->platters.sync_file(impl_->sync_in_doubt);
  impl_->platters.cut(chance);
  std::filesystem::remove(impl_->database + "-shm");
  impl_->sync_in_doubt.clear();
  impl_->cut_at = UINT64_MAX;
  impl_->is_cut = false;
}

void PowerCutDisk::refuse(int code, std::function<bool(DiskOperation, const std::string&)> fails) {
  const std::lock_guard lock(impl_->mutex);
  impl_->refusal = code;
  impl_->refuses = std::move(fails);
}

void PowerCutDisk::while_waiting(std::function<void()> meanwhile) {
  impl_->meanwhile = std::move(meanwhile);
}

}  // namespace gonio::test
