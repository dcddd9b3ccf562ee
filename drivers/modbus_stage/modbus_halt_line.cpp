#include "drivers/modbus_stage/modbus_halt_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace gonio::drivers {
namespace {

using stage::Field;

Result<void> with_words(Result<void> outcome, const std::string& tried) {
  if (!outcome) outcome.error().tried = fmt::format("{} ({})", tried, outcome.error().tried);
  return outcome;
}

}  // namespace

ModbusHaltLine::ModbusHaltLine(ModbusLink& halts, ModbusLink& beats, const stage::RegisterMap& map)
    : halt_link_(halts), beat_link_(beats), map_(map) {}

Result<void> ModbusHaltLine::halt(Epoch epoch) {
  const stage::Block block = map_.halt_block();
  std::vector<std::uint16_t> words(block.count);
  stage::encode(words, block.first, map_.at(Field::HaltEpoch), epoch);
  stage::encode(words, block.first, map_.at(Field::HaltKey), stage::kHaltKey);
  Result<void> sent = halt_link_.write_registers(block.first, words);
  for (int tries = 1; !sent && tries < kHaltTries; ++tries) sent = halt_link_.write_registers(block.first, words);
  return with_words(std::move(sent), fmt::format("halt with epoch {}", epoch));
}

Result<void> ModbusHaltLine::watch_heartbeat(Duration timeout) {
  const stage::Register& reg = map_.at(Field::HeartbeatTimeoutMs);
  const std::int64_t most = (std::int64_t{1} << (16 * reg.words - (reg.is_signed ? 1 : 0))) - 1;
  const auto whole_ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  std::vector<std::uint16_t> words(reg.words);
  stage::encode(words, reg.address, reg, std::clamp<std::int64_t>(whole_ms, 0, most));
  return with_words(beat_link_.write_registers(reg.address, words),
                    fmt::format("watch the heartbeat, {} ms", whole_ms));
}

Result<void> ModbusHaltLine::beat() {
  const stage::Register& reg = map_.at(Field::Heartbeat);
  std::vector<std::uint16_t> words(reg.words);
  ++beats_;
  stage::encode(words, reg.address, reg, beats_ & 0x7FFF);  // fits whatever the register's sign
  return with_words(beat_link_.write_registers(reg.address, words), "feed the heartbeat");
}

void ModbusHaltLine::interrupt() {
  beat_link_.interrupt();
}

}  // namespace gonio::drivers
