#include "daemon/app/recording.h"

#include <filesystem>

#include "daemon/app/log.h"
#include "daemon/store/store_reader.h"

namespace gonio::daemon {

std::int64_t last_event_of(const std::string& store_file) {
  constexpr std::int64_t kNotKnown = -1;  // of an older layout, say
  if (!std::filesystem::exists(store_file)) return 0;
  const Result<std::unique_ptr<StoreReader>> reader = StoreReader::open(store_file);
  return reader ? (*reader)->last_event().value_or(kNotKnown) : kNotKnown;
}

Result<std::unique_ptr<drivers::TapeWriter>> start_recording(const std::string& tape_file,
                                                             const std::string& store_file,
                                                             const Instrument& instrument, const std::string& boot_id,
                                                             const Clock& clock) {
  auto tape = drivers::TapeWriter::create({.file = tape_file},
                                          {.program_version = GONIO_VERSION,
                                           .instrument_text = instrument.text,
                                           .configuration_hash = instrument.sha256,
                                           .boot_id = boot_id,
                                           .utc = clock.utc_now(),
                                           .boottime = clock.now(),
                                           .last_event = last_event_of(store_file)},
                                          [](const Error& error) { log_error("recording ended: " + describe(error)); });
  if (tape) log_info("recording every exchange with the devices to " + tape_file);
  return tape;
}

}  // namespace gonio::daemon
