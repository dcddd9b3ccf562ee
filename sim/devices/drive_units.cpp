#include "sim/devices/drive_units.h"

namespace gonio::sim {

DriveUnits::DriveUnits(Instrument& instrument) : map_(*instrument.scene().stage.drives) {
  for (const stage::Axis axis : stage::kAllAxes) {
    const stage::DriveMap* drive = map_.map_of(axis);
    if (drive == nullptr) continue;
    units_[map_.axis(axis).unit_id] = &drives_.emplace_back(instrument, axis, *drive, map_.axis(axis));
  }
  if (map_.io) units_[map_.io->unit_id] = &couplers_.emplace_back(instrument, *map_.io);
}

RegisterFace* DriveUnits::unit(std::uint8_t id) {
  const auto found = units_.find(id);
  return found == units_.end() ? nullptr : found->second;
}

}  // namespace gonio::sim
