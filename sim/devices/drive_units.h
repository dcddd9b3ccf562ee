#pragma once

#include <cstdint>
#include <list>
#include <map>

#include "sim/devices/drive_face.h"
#include "sim/devices/io_face.h"
#include "sim/devices/register_face.h"

namespace gonio::sim {

/// The instrument's stage as one drive an axis and a coupler, each a unit of the same wire. Beneath them is the same
/// model as beneath `StageFace`: the truth is one. Threads: one at a time, as the instrument.
class DriveUnits final : public ModbusUnits {
 public:
  /// `instrument`, whose scene has drives, must outlive it.
  explicit DriveUnits(Instrument& instrument);

  [[nodiscard]] RegisterFace* unit(std::uint8_t id) override;

 private:
  const stage::DriveStageMap& map_;
  std::list<DriveFace> drives_;
  std::list<IoFace> couplers_;
  std::map<std::uint8_t, RegisterFace*> units_;
};

}  // namespace gonio::sim
