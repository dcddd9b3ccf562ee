// Tapes: a file as it is, or payloads to which the input lends their lengths and checksums.
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/links/tape/packing.h"
#include "drivers/links/tape/tape_format.h"
#include "drivers/links/tape/tape_reader.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

const std::string kName = "night.tape";

void append_record(std::string& file, Bytes payload) {
  for (const auto number : {static_cast<std::uint32_t>(payload.size()), drivers::crc32_of(payload)}) {
    for (unsigned shift = 0; shift < 32; shift += 8) file.push_back(static_cast<char>(number >> shift & 0xFFU));
  }
  file.append(text_of(payload));
}

// A good beginning, then the input's payloads, each in a record that is whole.
std::string recorded(ByteSource& source) {
  std::string file(drivers::kTapeMagic.begin(), drivers::kTapeMagic.end());
  append_record(file, drivers::encode_record(drivers::TapeStart{.program_version = "1"}));
  while (!source.is_empty()) append_record(file, source.some(source.word()));
  return file;
}

void read_through(const std::string& file) {
  auto reader = drivers::TapeReader::read_from(std::make_unique<std::istringstream>(file), kName);
  if (!reader) {
    hold_error(reader.error());
    return;
  }
  for (std::size_t records = 0;; ++records) {
    hold(records * drivers::kTapeRecordHead <= file.size(), "a tape has no more records than bytes for them");
    const auto record = reader->next();
    if (!record) {
      hold_error(record.error());
      return;
    }
    if (!*record) break;
    const auto same = drivers::decode_record(drivers::encode_record(**record));
    hold(same && *same == **record, "a record that is written reads back");
  }
  hold(!reader->tail().empty(), "a tape says how it ended");
}

}  // namespace

void tape(Bytes input) {
  ByteSource source(input);
  if ((source.byte() & 1U) != 0) return read_through(recorded(source));
  read_through(std::string(text_of(source.rest())));
}

}  // namespace gonio::fuzz
