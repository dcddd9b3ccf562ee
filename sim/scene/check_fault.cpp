#include "sim/scene/check_fault.h"

#include <algorithm>
#include <string>

namespace gonio::sim {
namespace {

tl::unexpected<Error> nobody_to_meet(const PlannedFault& fault, std::string seen, std::string limit) {
  return failure({.code = ErrorCode::InvalidInput,
                  .device = "goniosim",
                  .tried = "arm the fault \"" + std::string(traits(fault.kind).name) + '"',
                  .seen = std::move(seen),
                  .limit = std::move(limit)});
}

}  // namespace

Result<void> check_fault(const PlannedFault& fault, const Scene& scene) {
  if (fault.kind == FaultKind::DrivePowerCycle && !scene.stage.drives) {
    return nobody_to_meet(fault, "the stage of this run is one controller", "--stage drives");
  }
  if (traits(fault.kind).device != FaultDevice::Radiometer) return {};
  const auto place = fault.role() == FaultRole::Detector ? RadiometerPlace::Detector : RadiometerPlace::Monitor;
  const std::string role(kFaultRoleNames[static_cast<std::size_t>(fault.role())]);
  const bool is_there =
      std::ranges::any_of(scene.radiometers, [&](const RadiometerSpec& spec) { return spec.place == place; });
  if (is_there) return {};
  return nobody_to_meet(fault, "the scene has no radiometer as " + role, "[[radiometers]] with role = \"" + role + '"');
}

}  // namespace gonio::sim
