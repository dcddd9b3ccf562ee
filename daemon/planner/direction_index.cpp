#include "daemon/planner/direction_index.h"

#include <cmath>
#include <numbers>

#include "daemon/planner/chance.h"

namespace gonio::daemon {

namespace {

constexpr double kSame_rad = 1e-9;

std::int64_t count_of(Angle a) {
  return std::llround(a.si() / kSame_rad);
}

std::int64_t azimuth_of(Angle a) {
  const std::int64_t half_turn = std::llround(std::numbers::pi / kSame_rad);
  const std::int64_t count = count_of(wrapped(a));
  return count <= -half_turn ? half_turn : count;
}

}  // namespace

DirectionIndex::Key DirectionIndex::key_of(const Geometry& g, Wavelength wavelength) const {
  constexpr double kSame_m = 1e-15;  // a millionth of a nanometre
  Key key{count_of(g.theta_i), azimuth_of(g.phi_i), count_of(g.theta_r),
          azimuth_of(isotropic_ ? g.phi_r - g.phi_i : g.phi_r), std::llround(wavelength.si() / kSame_m)};
  const bool at_source_pole = key[0] == 0;
  const bool at_detector_pole = key[2] == 0;
  if (at_detector_pole || (isotropic_ && at_source_pole)) key[3] = 0;
  if (isotropic_ && (at_source_pole || at_detector_pole)) key[1] = 0;
  return key;
}

std::size_t DirectionIndex::slot_of(const Key& key) const {
  std::uint64_t mixed = 0;
  for (const std::int64_t part : key) mixed = Chance(mixed ^ static_cast<std::uint64_t>(part)).next();
  std::size_t slot = static_cast<std::size_t>(mixed) & (slots_.size() - 1);
  while (slots_[slot] >= 0 && keys_[static_cast<std::size_t>(slots_[slot])] != key) {
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return slot;
}

void DirectionIndex::grow() {
  constexpr std::size_t kFirst = 1024;  // a power of two, and so all others
  slots_.assign(slots_.empty() ? kFirst : 2 * slots_.size(), -1);
  for (std::size_t k = 0; k < keys_.size(); ++k) slots_[slot_of(keys_[k])] = static_cast<std::int32_t>(k);
}

std::optional<std::int32_t> DirectionIndex::find(const Geometry& g, Wavelength wavelength) const {
  if (slots_.empty()) return std::nullopt;
  const std::int32_t number = slots_[slot_of(key_of(g, wavelength))];
  return number < 0 ? std::nullopt : std::optional(number);
}

std::optional<std::int32_t> DirectionIndex::find_or_add(const Geometry& g, Wavelength wavelength, std::int32_t number) {
  if (2 * (keys_.size() + 1) > slots_.size()) grow();
  const Key key = key_of(g, wavelength);
  const std::size_t slot = slot_of(key);
  if (slots_[slot] >= 0) return slots_[slot];
  keys_.push_back(key);
  slots_[slot] = number;
  return std::nullopt;
}

}  // namespace gonio::daemon
