#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calibration/budget.h"

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
  };

  /// The component's index; `make` is only asked when it is new.
  template <class Make>
  std::uint32_t index(const Key& key, const Make& make) {
    if (2 * (keys_.size() + 1) > slots_.size()) grow();
    std::size_t slot = hash(key) & (slots_.size() - 1);
    for (; slots_[slot] != kFree; slot = (slot + 1) & (slots_.size() - 1)) {
      if (keys_[slots_[slot]] == key) return slots_[slot];
    }
    slots_[slot] = static_cast<std::uint32_t>(keys_.size());
    keys_.push_back(key);
    components_.push_back(make());
    return slots_[slot];
  }

  [[nodiscard]] const std::vector<Component>& components() const { return components_; }

  /// Takes up another table's components. [n]: the index here of its component n.
  std::vector<std::uint32_t> join(const ComponentTable& other) {
    std::vector<std::uint32_t> indices;
    for (std::size_t n = 0; n < other.keys_.size(); ++n) {
      indices.push_back(index(other.keys_[n], [&] { return other.components_[n]; }));
    }
    return indices;
  }

 private:
  static constexpr std::uint32_t kFree = ~std::uint32_t{0};

  static std::size_t hash(const Key& key) {  // SplitMix64's steps (Steele, Lea and Flood 2014)
    constexpr std::uint64_t kMix = 0xBF58476D1CE4E5B9ULL;
    std::uint64_t z = static_cast<std::uint64_t>(key.source) * kMix;
    for (const std::int64_t part : {key.a, key.b, key.c}) {
      z = (z ^ static_cast<std::uint64_t>(part)) * kMix;
      z ^= z >> 29U;
    }
    return z;
  }

  void grow() {
    constexpr std::size_t kFirst = 128;
    slots_.assign(slots_.empty() ? kFirst : 2 * slots_.size(), kFree);
    for (std::size_t n = 0; n < keys_.size(); ++n) {
      std::size_t slot = hash(keys_[n]) & (slots_.size() - 1);
      while (slots_[slot] != kFree) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<std::uint32_t>(n);
    }
  }

  std::vector<Component> components_;
  std::vector<Key> keys_;
  std::vector<std::uint32_t> slots_;  ///< open addressing; a power of two
};

}  // namespace gonio::calibration
