#include "drivers/links/tape/tape_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "drivers/links/tape/packing.h"
#include "drivers/links/tape/tape_bytes.h"
#include "drivers/links/tape/tape_format.h"

namespace gonio::drivers {
namespace {

// What is asked for at once: a length that lies makes nothing larger than the file is.
constexpr std::size_t kPiece = std::size_t{1} << 20U;

tl::unexpected<Error> not_a_tape(const std::string& name, std::string seen, std::string limit = {}) {
  return failure({.code = ErrorCode::InvalidInput,
                  .device = "tape",
                  .tried = "open the tape",
                  .seen = std::move(seen),
                  .limit = std::move(limit),
                  .where = InputLocation{name, 0, {}}});
}

}  // namespace

TapeReader::TapeReader(std::unique_ptr<std::istream> in, std::string name)
    : in_(std::move(in)), name_(std::move(name)) {}
TapeReader::TapeReader(TapeReader&&) noexcept = default;
TapeReader& TapeReader::operator=(TapeReader&&) noexcept = default;
TapeReader::~TapeReader() = default;

Result<TapeReader> TapeReader::open(const std::string& file) {
  auto in = std::make_unique<std::ifstream>(file, std::ios::binary);
  if (!*in) {
    return failure({.code = ErrorCode::FileUnreadable,
                    .device = "tape",
                    .tried = "open the tape",
                    .seen = "it cannot be read",
                    .limit = {},
                    .where = InputLocation{file, 0, {}}});
  }
  return read_from(std::move(in), file);
}

Result<TapeReader> TapeReader::read_from(std::unique_ptr<std::istream> in, std::string name) {
  TapeReader reader(std::move(in), std::move(name));
  std::vector<std::uint8_t> magic;
  if (reader.fill(magic, kTapeMagic.size()) < kTapeMagic.size() ||
      !std::equal(kTapeMagic.begin(), kTapeMagic.end() - 1, magic.begin())) {
    return not_a_tape(reader.name_, "it does not begin like a tape");
  }
  if (magic.back() != kTapeMagic.back()) {
    return not_a_tape(reader.name_, fmt::format("layout version {}", magic.back()),
                      fmt::format("version {}", kTapeMagic.back()));
  }
  Result<std::optional<TapeRecord>> first = reader.next();
  if (!first) return failure(std::move(first).error());
  auto* start = *first ? std::get_if<TapeStart>(&**first) : nullptr;
  if (start == nullptr) return not_a_tape(reader.name_, "it ends before its start was written");
  reader.start_ = std::move(*start);
  return reader;
}

std::size_t TapeReader::fill(std::vector<std::uint8_t>& bytes, std::size_t wanted) {
  bytes.clear();
  while (bytes.size() < wanted && in_->good()) {
    const std::size_t before = bytes.size();
    bytes.resize(before + std::min(kPiece, wanted - before));
    in_->read(reinterpret_cast<char*>(bytes.data() + before), static_cast<std::streamsize>(bytes.size() - before));
    bytes.resize(before + static_cast<std::size_t>(in_->gcount()));
  }
  read_ += static_cast<std::int64_t>(bytes.size());
  return bytes.size();
}

tl::unexpected<Error> TapeReader::damaged(const std::string& seen) const {
  return failure({.code = ErrorCode::IncompleteData,
                  .device = "tape",
                  .tried = fmt::format("read record {}, {} bytes into the file", number_ + 1, place_),
                  .seen = seen,
                  .limit = {},
                  .where = InputLocation{name_, 0, {}}});
}

Result<std::optional<TapeRecord>> TapeReader::next() {
  Result<std::optional<TapeRecord>> record = read_record();
  if (record && *record) ++number_;
  return record;
}

std::optional<TapeRecord> TapeReader::cut_off(std::string how) {
  tail_ = std::move(how);
  is_cut_off_ = true;
  return std::nullopt;
}

Result<std::optional<TapeRecord>> TapeReader::read_record() {
  if (!tail_.empty()) return std::nullopt;
  place_ = read_;
  std::vector<std::uint8_t> head;
  if (fill(head, kTapeRecordHead) == 0) {
    return cut_off("cut off between two records");
  }
  ByteReader words(head);
  const std::size_t length = words.u32();
  const std::uint32_t crc = words.u32();
  if (words.is_whole() && (length == 0 || length > kMostPayload)) {
    return damaged(fmt::format("a record of {} bytes", length));
  }
  std::vector<std::uint8_t> payload;
  if (!words.is_whole() || fill(payload, length) < length) {
    return cut_off(fmt::format("cut off within a record: {} bytes dropped", read_ - place_));
  }
  if (crc32_of(payload) != crc) {
    // A file system that lost power may have the length of the last record and not its bytes.
    if (in_->peek() != std::istream::traits_type::eof()) return damaged("its checksum does not fit");
    return cut_off(fmt::format("cut off within a record: {} bytes dropped", read_ - place_));
  }
  Result<TapeRecord> record = decode_record(payload);
  if (!record) return damaged(record.error().seen);
  if (const auto* end = std::get_if<TapeEnd>(&*record)) {
    tail_ = end->reason.empty() ? "ended" : end->reason;
    return std::nullopt;
  }
  return std::optional<TapeRecord>(std::move(*record));
}

}  // namespace gonio::drivers
