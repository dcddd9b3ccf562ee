#include "tests/support/in_process_unit_link.h"

#include <algorithm>
#include <string>

namespace gonio::test {
namespace {

using Parts = sim::LiveInstrument::Parts;

Error link_error(ErrorCode code, std::string seen) {
  return {.code = code, .device = "stage", .tried = "talk", .seen = std::move(seen)};
}

Result<void> outcome(std::optional<sim::ModbusException> refused) {
  if (!refused) return {};
  return failure(link_error(ErrorCode::DeviceRefused, "exception " + std::to_string(static_cast<int>(*refused))));
}

}  // namespace

InProcessUnitLink::Next InProcessUnitLink::next() {
  ++transactions;
  if (is_dead) return Next::LoseRequest;
  if (script.empty()) return Next::Obey;
  const Next now = script.front();
  script.pop_front();
  return now;
}

Result<void> InProcessUnitLink::read_registers(std::uint16_t first, std::span<std::uint16_t> into) {
  const Next now = next();
  if (now == Next::LoseRequest) return failure(link_error(ErrorCode::TimedOut, "no reply"));
  const auto refused =
      instrument_.with([&](Parts& parts) { return parts.units.unit(unit_)->read(first, into, parts.now); });
  if (now == Next::LoseReply) return failure(link_error(ErrorCode::TimedOut, "no reply"));
  if (now == Next::OtherReply) std::ranges::fill(into, std::uint16_t{0x1234});
  return outcome(refused);
}

Result<void> InProcessUnitLink::write_registers(std::uint16_t first, std::span<const std::uint16_t> words) {
  const Next now = next();
  if (now == Next::LoseRequest) return failure(link_error(ErrorCode::TimedOut, "no reply"));
  writes.push_back({first, {words.begin(), words.end()}});
  before_write(writes.back());
  const auto refused =
      instrument_.with([&](Parts& parts) { return parts.units.unit(unit_)->write(first, words, parts.now); });
  if (now == Next::LoseReply) return failure(link_error(ErrorCode::TimedOut, "no reply"));
  return outcome(refused);
}

Result<void> InProcessUnitLink::write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                               std::uint16_t read_first, std::span<std::uint16_t> into) {
  GONIO_TRY(write_registers(write_first, words));
  return read_registers(read_first, into);
}

}  // namespace gonio::test
