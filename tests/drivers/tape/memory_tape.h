#pragma once

#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/links/tape/packing.h"
#include "drivers/links/tape/tape_bytes.h"
#include "drivers/links/tape/tape_format.h"
#include "drivers/links/tape/tape_reader.h"
#include "drivers/links/tape/tape_sink.h"

namespace gonio::drivers::test {

/// A tape in memory, to be played without a file.
class MemoryTape final : public TapeSink {
 public:
  void put(TapeRecord record) override { records.push_back(std::move(record)); }

  /// The bytes of a file with a start and these records.
  [[nodiscard]] std::string file() const {
    std::string bytes(kTapeMagic.begin(), kTapeMagic.end());
    append(bytes, encode_record(TapeStart{.program_version = "1", .boottime = Instant(Duration(1000))}));
    for (const TapeRecord& record : records) append(bytes, encode_record(record));
    return bytes;
  }
  static void append(std::string& bytes, const std::vector<std::uint8_t>& payload) {
    const std::vector<std::uint8_t> head =
        ByteWriter().u32(static_cast<std::uint32_t>(payload.size())).u32(crc32_of(payload)).take();
    bytes.append(head.begin(), head.end());
    bytes.append(payload.begin(), payload.end());
  }
  static Result<TapeReader> read(const std::string& bytes) {
    return TapeReader::read_from(std::make_unique<std::istringstream>(bytes), "night.tape");
  }

  std::vector<TapeRecord> records;
};

}  // namespace gonio::drivers::test
