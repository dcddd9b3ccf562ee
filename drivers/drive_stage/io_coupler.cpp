#include "drivers/drive_stage/io_coupler.h"

#include <fmt/format.h>

#include <array>
#include <set>

namespace gonio::drivers {

using stage::ShutterState;

namespace {

constexpr std::uint16_t kMostReadAtOnce = 125;

// Registers that follow each other are read at once; a gap may hold what must not be read.
std::vector<stage::Block> runs_of(const std::set<std::uint16_t>& addresses) {
  std::vector<stage::Block> runs;
  for (const std::uint16_t address : addresses) {
    const bool goes_on =
        !runs.empty() && runs.back().first + runs.back().count == address && runs.back().count < kMostReadAtOnce;
    if (goes_on) ++runs.back().count;
    if (!goes_on) runs.push_back({address, 1});
  }
  return runs;
}

std::vector<stage::Block> runs_of(const stage::IoMap& map) {
  std::set<std::uint16_t> addresses;
  const auto add = [&](const stage::Register& reg) {
    for (unsigned k = 0; k < reg.words; ++k) addresses.insert(static_cast<std::uint16_t>(reg.address + k));
  };
  for (const auto* bits :
       {&map.source_shutter_open, &map.detector_shutter_open, &map.source_shutter_closed, &map.detector_shutter_closed,
        &map.interlock_open, &map.source_shutter, &map.detector_shutter}) {
    if (*bits) add((*bits)->reg);
  }
  for (const auto* number : {&map.monitor, &map.lamp_temperature_c, &map.detector_temperature_c,
                             &map.room_temperature_c, &map.humidity_percent}) {
    if (*number) add((*number)->reg);
  }
  return runs_of(addresses);
}

}  // namespace

IoCoupler::IoCoupler(UnitLine& line, const stage::IoMap& map, const Clock& clock, Duration travel)
    : line_(line),
      map_(map),
      clock_(clock),
      travel_(travel),
      source_{"source shutter", map.source_shutter, map.source_shutter_open, map.source_shutter_closed, {}},
      detector_{"detector shutter", map.detector_shutter, map.detector_shutter_open, map.detector_shutter_closed, {}},
      runs_(runs_of(map)) {}

Result<void> IoCoupler::read_all() {
  words_.clear();
  for (const stage::Block& run : runs_) {
    std::vector<std::uint16_t> words(run.count);
    GONIO_TRY(line_.read_run(run.first, words, "read its inputs"));
    for (std::size_t k = 0; k < words.size(); ++k) words_[static_cast<std::uint16_t>(run.first + k)] = words[k];
  }
  return {};
}

std::int64_t IoCoupler::raw(const stage::Register& reg) const {
  std::array<std::uint16_t, 2> words{};
  for (unsigned k = 0; k < reg.words; ++k) words.at(k) = words_.at(static_cast<std::uint16_t>(reg.address + k));
  return stage::decode(std::span(words).first(reg.words), reg.address, reg);
}

bool IoCoupler::is(const std::optional<stage::IoBits>& bits) const {
  return bits && (raw(bits->reg) & bits->mask) == bits->value;
}

double IoCoupler::value(const std::optional<stage::IoNumber>& number, double otherwise) const {
  return number ? number->offset + static_cast<double>(raw(number->reg)) * number->scale : otherwise;
}

ShutterState IoCoupler::state_of(const Shutter& shutter) const {
  if (!shutter.output) return ShutterState::Open;
  const bool wants_open = is(shutter.output);
  const auto& end_switch = wants_open ? shutter.open : shutter.closed;
  const auto& other_switch = wants_open ? shutter.closed : shutter.open;
  const ShutterState wanted = wants_open ? ShutterState::Open : ShutterState::Closed;
  if (end_switch) return is(end_switch) ? wanted : ShutterState::Moving;
  const bool has_left = !other_switch || !is(other_switch);
  const bool has_had_time = !shutter.told || clock_.now() >= *shutter.told + travel_;
  return has_left && has_had_time ? wanted : ShutterState::Moving;
}

Result<void> IoCoupler::look(StageState& state) {
  GONIO_TRY(read_all());
  state.source_shutter = state_of(source_);
  state.detector_shutter = state_of(detector_);
  state.interlock_open = is(map_.interlock_open);
  state.monitor = value(map_.monitor, 1.0);
  state.lamp_temperature_c = value(map_.lamp_temperature_c, 0.0);
  state.detector_temperature_c = value(map_.detector_temperature_c, 0.0);
  state.room_temperature_c = value(map_.room_temperature_c, 0.0);
  state.humidity_percent = value(map_.humidity_percent, 0.0);
  return {};
}

Result<void> IoCoupler::set(Shutter& shutter, bool open) {
  const std::string what = fmt::format("{} the {}", open ? "open" : "close", shutter.name);
  if (!shutter.output) {
    if (open) return {};
    return failure(line_.error(ErrorCode::DeviceRefused, what, "the instrument's file has none"));
  }
  const stage::IoBits& bits = *shutter.output;
  const std::int64_t value = open ? bits.value : ~bits.value & bits.mask;
  GONIO_TRY(line_.write_bits(bits.reg, bits.mask, value, what));
  shutter.told = clock_.now();
  return {};
}

Result<void> IoCoupler::set_shutters(bool source_open, bool detector_open) {
  GONIO_TRY(set(source_, source_open));
  return set(detector_, detector_open);
}

}  // namespace gonio::drivers
