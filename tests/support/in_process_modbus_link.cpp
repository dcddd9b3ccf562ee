#include "tests/support/in_process_modbus_link.h"

#include <string>

namespace gonio::test {
namespace {

using Parts = sim::LiveInstrument::Parts;

Result<void> outcome(std::optional<sim::ModbusException> refused, const std::string& tried) {
  if (!refused) return {};
  return failure({.code = ErrorCode::DeviceRefused,
                  .device = "stage",
                  .tried = tried,
                  .seen = "exception " + std::to_string(static_cast<int>(*refused))});
}

std::string text(const std::string& verb, std::size_t count, std::uint16_t first) {
  return verb + " " + std::to_string(count) + " registers from " + std::to_string(first);
}

}  // namespace

Result<void> InProcessModbusLink::read_registers(std::uint16_t first, std::span<std::uint16_t> into) {
  if (broken_) return failure(*broken_);
  return outcome(instrument_.with([&](Parts& parts) { return parts.stage.read(first, into, parts.now); }),
                 text("read", into.size(), first));
}

Result<void> InProcessModbusLink::write_registers(std::uint16_t first, std::span<const std::uint16_t> words) {
  if (broken_) return failure(*broken_);
  return outcome(instrument_.with([&](Parts& parts) { return parts.stage.write(first, words, parts.now); }),
                 text("write", words.size(), first));
}

Result<void> InProcessModbusLink::write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                                 std::uint16_t read_first, std::span<std::uint16_t> into) {
  GONIO_TRY(write_registers(write_first, words));
  return read_registers(read_first, into);
}

}  // namespace gonio::test
