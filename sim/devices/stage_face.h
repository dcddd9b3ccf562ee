#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/clock.h"
#include "protocol/stage/register_map.h"
#include "sim/devices/instrument.h"
#include "sim/devices/register_face.h"

namespace gonio::sim {

/// The stage as its holding registers: what a Modbus master sees, without the wire. Acts on a write at once, in the
/// order of protocol/stage/README.md. Threads: one at a time, as the instrument.
class StageFace final : public RegisterFace, public ModbusUnits {
 public:
  /// `instrument` must outlive it; the map is the scene's.
  explicit StageFace(Instrument& instrument);

  /// Reads `out.size()` registers from `first` on.
  std::optional<ModbusException> read(std::uint16_t first, std::span<std::uint16_t> out, Instant now) override;
  /// Writes registers: all of them must take commands (or be the token). Nothing is written when refused, except that a
  /// key other than the right one, or a reset below the stage's epoch, is refused with IllegalValue.
  std::optional<ModbusException> write(std::uint16_t first, std::span<const std::uint16_t> values,
                                       Instant now) override;
  /// The only unit: by the map's id, and by the one that means "the device itself" (Modbus Messaging on TCP/IP V1.0b,
  /// 4.4.2.2).
  [[nodiscard]] RegisterFace* unit(std::uint8_t id) override {
    constexpr std::uint8_t kDeviceItself = 0xFF;
    return id == map_.unit_id || id == kDeviceItself ? this : nullptr;
  }

  [[nodiscard]] const stage::RegisterMap& map() const { return map_; }

 private:
  [[nodiscard]] bool covers(std::uint16_t first, std::size_t count, const stage::Register& reg) const;
  [[nodiscard]] std::int64_t value(stage::Field field) const;
  void put(stage::Field field, std::int64_t value);
  void put(stage::Axis axis, stage::AxisField field, std::int64_t value);
  void refresh(Instant now);
  void refresh_gate();
  void refresh_axes(Instant now);
  [[nodiscard]] MotionCommand motion_command() const;
  [[nodiscard]] std::optional<ModbusException> act(std::uint16_t first, std::size_t count, Instant now);

  Instrument& instrument_;
  stage::RegisterMap map_;
  std::vector<std::uint16_t> words_;  ///< every register from 0 to the map's last
  std::vector<bool> is_register_;
  std::vector<bool> is_writable_;
};

}  // namespace gonio::sim
