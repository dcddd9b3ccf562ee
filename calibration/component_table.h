#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "calibration/budget.h"

namespace gonio::calibration {

/// Every kind of component that a budget of this room can have; the number orders the table's keys and is stored
/// nowhere.
enum class ComponentSource : std::uint8_t {
  SampleNoise,
  SampleMonitor,
  SampleAngles,
  SampleReproducibility,
  ReferenceNoise,
  ReferenceMonitor,
  ReferenceAngles,
  ReferenceReproducibility,
  Certificate,
  ShapeMode,
  ShapeIntegral,
  ShapeInterpolation,
  Zero,
  UnresolvedSlope,
  ExposureOffset,
  Linearity,
  Lamp,
  DarkNoise,
  DarkDrift,
  SharedReference,
  Range,
  VisitNoise,
  Drift,
};

/// Numbers the components of a scan as they first appear.
class ComponentTable {
 public:
  /// What tells components of one source apart: a mode, an axis, visits, a rung, a reading.
  using Key = std::tuple<ComponentSource, std::int64_t, std::int64_t, std::int64_t>;

  /// The component's index; `make` is only asked when it is new.
  template <class Make>
  std::uint32_t index(const Key& key, Make make) {
    const auto [entry, is_new] = indices_.try_emplace(key, static_cast<std::uint32_t>(components_.size()));
    if (is_new) components_.push_back(make());
    return entry->second;
  }

  [[nodiscard]] const std::vector<Component>& components() const { return components_; }

 private:
  std::map<Key, std::uint32_t> indices_;
  std::vector<Component> components_;
};

}  // namespace gonio::calibration
