#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/geometry.h"
#include "base/units.h"

namespace gonio::daemon {

/// Finds directions that are the same: equal in theta, in phi but for whole turns, and in wavelength; at the detector's
/// pole phi_r means nothing, and an isotropic sample looks the same from all sides, so that there nothing but theta
/// counts at either pole. Angles count as equal when they are the same after rounding to 1e-9 rad, so no chain of
/// neighbours merges.
class DirectionIndex {
 public:
  explicit DirectionIndex(bool isotropic) : isotropic_(isotropic) {}

  /// The number that this direction was first given, if it is known; else it gets `number`, which must count up from 0.
  [[nodiscard]] std::optional<std::int32_t> find_or_add(const Geometry& g, Wavelength wavelength, std::int32_t number);
  [[nodiscard]] std::optional<std::int32_t> find(const Geometry& g, Wavelength wavelength) const;

 private:
  using Key = std::array<std::int64_t, 5>;
  [[nodiscard]] Key key_of(const Geometry& g, Wavelength wavelength) const;
  [[nodiscard]] std::size_t slot_of(const Key& key) const;
  void grow();

  bool isotropic_;
  std::vector<Key> keys_;            ///< by number
  std::vector<std::int32_t> slots_;  ///< open addressing; -1: empty
};

}  // namespace gonio::daemon
