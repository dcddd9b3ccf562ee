#include "sim/devices/io_face.h"

#include <algorithm>
#include <cmath>

namespace gonio::sim {

IoFace::IoFace(Instrument& instrument, const stage::IoMap& map) : instrument_(instrument), map_(map) {
  for (const auto* output : {&map.source_shutter, &map.detector_shutter}) {
    if (*output) bank_.add((*output)->reg, true);
  }
  for (const auto* input : {&map.source_shutter_open, &map.detector_shutter_open, &map.source_shutter_closed,
                            &map.detector_shutter_closed, &map.interlock_open}) {
    if (*input) bank_.add((*input)->reg, false);
  }
  for (const auto* number : {&map.monitor, &map.lamp_temperature_c, &map.detector_temperature_c,
                             &map.room_temperature_c, &map.humidity_percent}) {
    if (*number) bank_.add((*number)->reg, false);
  }
}

bool IoFace::is(const std::optional<stage::IoBits>& bits) const {
  return bits && (bank_.get(bits->reg) & bits->mask) == bits->value;
}

void IoFace::show(const std::optional<stage::IoBits>& bits, bool on) {
  if (!bits) return;
  const std::int64_t shown = on ? bits->value : ~bits->value & bits->mask;
  bank_.set(bits->reg, (bank_.get(bits->reg) & ~bits->mask) | shown);
}

void IoFace::show(const std::optional<stage::IoNumber>& number, double value) {
  if (!number) return;
  const stage::Register& reg = number->reg;
  const double most = std::ldexp(1.0, reg.words * 16 - (reg.is_signed ? 1 : 0)) - 1.0;
  const double counts = std::clamp((value - number->offset) / number->scale, reg.is_signed ? -most : 0.0, most);
  bank_.set(reg, std::llround(counts));
}

void IoFace::show(Instant now) {
  const StageModel& stage = instrument_.stage();
  const EnvironmentSpec& environment = instrument_.scene().environment;
  const stage::ShutterState source = stage.source_shutter().state(now);
  const stage::ShutterState detector = stage.detector_shutter().state(now);
  show(map_.source_shutter, stage.source_shutter().wants_open);
  show(map_.detector_shutter, stage.detector_shutter().wants_open);
  show(map_.source_shutter_open, source == stage::ShutterState::Open);
  show(map_.source_shutter_closed, source == stage::ShutterState::Closed);
  show(map_.detector_shutter_open, detector == stage::ShutterState::Open);
  show(map_.detector_shutter_closed, detector == stage::ShutterState::Closed);
  show(map_.interlock_open, stage.is_interlock_open());
  show(map_.monitor, instrument_.monitor_now(now));
  show(map_.lamp_temperature_c, in_celsius(environment.lamp));
  show(map_.detector_temperature_c, in_celsius(environment.detector));
  show(map_.room_temperature_c, in_celsius(environment.room));
  show(map_.humidity_percent, environment.humidity_percent);
}

std::optional<ModbusException> IoFace::read(std::uint16_t first, std::span<std::uint16_t> out, Instant now) {
  instrument_.advance_to(now);
  show(now);
  return bank_.read(first, out);
}

std::optional<ModbusException> IoFace::write(std::uint16_t first, std::span<const std::uint16_t> values, Instant now) {
  instrument_.advance_to(now);
  show(now);
  if (const auto refused = bank_.write(first, values)) return refused;
  const auto is_told_open = [&](const auto& output) { return !output || is(output); };  // none: nothing to close
  instrument_.stage().set_shutters(is_told_open(map_.source_shutter), is_told_open(map_.detector_shutter), now);
  return std::nullopt;
}

}  // namespace gonio::sim
