#pragma once

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "drivers/links/tape/tape_record.h"

namespace gonio::drivers {

/// Reads a tape from its beginning, record by record: a night need not fit into memory. Holds one record at a time,
/// 64 MiB of payload and 64 Mi pixels at most, whatever the file says. Threads: one.
class TapeReader {
 public:
  /// Errors: FileUnreadable (not there), InvalidInput (not a tape, another version, no start).
  [[nodiscard]] static Result<TapeReader> open(const std::string& file);
  /// The same from a stream, for tests and fuzzers; `name` stands in errors.
  [[nodiscard]] static Result<TapeReader> read_from(std::unique_ptr<std::istream> in, std::string name);

  TapeReader(TapeReader&&) noexcept;
  TapeReader& operator=(TapeReader&&) noexcept;
  ~TapeReader();

  [[nodiscard]] const TapeStart& start() const { return start_; }

  /// The next record, or nothing at the end. A record that is torn at the very end, as a killed program leaves it, is
  /// the end too (`tail` says so). Errors: IncompleteData (damage in the midst: the record's number and place).
  [[nodiscard]] Result<std::optional<TapeRecord>> next();

  /// Of the record that `next` gave last, from 0 for the start.
  [[nodiscard]] std::int64_t number() const { return number_; }
  /// How the tape ended, once `next` has said that it did: "ended", "cut off within a record: 17 bytes dropped".
  [[nodiscard]] const std::string& tail() const { return tail_; }
  /// By then: that its last record is not an end, as a killed program leaves it.
  [[nodiscard]] bool is_cut_off() const { return is_cut_off_; }

 private:
  TapeReader(std::unique_ptr<std::istream> in, std::string name);
  [[nodiscard]] Result<std::optional<TapeRecord>> read_record();
  [[nodiscard]] std::size_t fill(std::vector<std::uint8_t>& bytes, std::size_t wanted);
  [[nodiscard]] std::optional<TapeRecord> cut_off(std::string how);
  [[nodiscard]] tl::unexpected<Error> damaged(const std::string& seen) const;

  std::unique_ptr<std::istream> in_;
  std::string name_;
  TapeStart start_;
  std::int64_t number_ = -1;
  std::int64_t place_ = 0;  ///< of the record under way, in bytes
  std::int64_t read_ = 0;
  std::string tail_;
  bool is_cut_off_ = false;
};

}  // namespace gonio::drivers
