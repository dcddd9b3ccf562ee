#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calibration/budget.h"
#include "calibration/key_numbers.h"

namespace gonio::calibration {

/// Every kind of component that a budget of this room can have; the number orders nothing and is stored nowhere.
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
  DriftRest,
  LinearityFit,
  Gain,
  Ambient,
  AmbientVisit,
  StrayVisit,
  SourceStray,
  InternalStray,
  ConeSize,
  ConeCurvature,
  ConeNoise,
  Polarisation,
  Mounting,
  UnresolvedMounting,
  Centroid,
  Bandwidth,
  Geometry,    ///< of what does not cancel between two geometries
  DirectBeam,  ///< of what stands in the standard's place
};

/// Numbers the components of a scan, or of a part of it, as they first appear.
class ComponentTable {
 public:
  /// What tells components of one source apart: a mode, an axis, visits, a rung, a reading.
  struct Key {
    ComponentSource source = ComponentSource::SampleNoise;
    std::int64_t a = 0;
    std::int64_t b = 0;
    std::int64_t c = 0;
    friend bool operator==(const Key&, const Key&) = default;
    [[nodiscard]] std::size_t hash() const { return mixed({static_cast<std::int64_t>(source), a, b, c}); }
  };

  /// The component's index; `make` is only asked when it is new.
  template <class Make>
  std::uint32_t index(const Key& key, const Make& make) {
    if (place_ < course_.size() && numbers_.keys()[course_[place_]] == key) return course_[place_++];
    const std::uint32_t number = numbers_.number_of(key);
    if (number == components_.size()) components_.push_back(make());
    if (place_ == course_.size()) course_.push_back(number);
    return course_[place_++] = number;
  }
  /// The components of another point follow, likely the last one's in the same order: then none is searched for.
  void begin_point() { place_ = 0; }

  [[nodiscard]] const std::vector<Component>& components() const { return components_; }

  /// Takes up another table's components. [n]: the index here of its component n.
  std::vector<std::uint32_t> join(const ComponentTable& other) {
    std::vector<std::uint32_t> indices;
    const std::vector<Key>& keys = other.numbers_.keys();
    for (std::size_t n = 0; n < keys.size(); ++n) {
      indices.push_back(index(keys[n], [&] { return other.components_[n]; }));
    }
    return indices;
  }

 private:
  std::vector<Component> components_;
  KeyNumbers<Key> numbers_;
  std::vector<std::uint32_t> course_;  ///< the components of the last point as they were asked for
  std::size_t place_ = 0;              ///< in it
};

}  // namespace gonio::calibration
