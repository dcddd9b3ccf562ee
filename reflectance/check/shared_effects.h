#pragma once

#include <cstdint>
#include <vector>

#include "reflectance/check/symmetry_point.h"

namespace gonio::reflectance {

/// The effects of shared components on one value, those of one component added, in order of the components.
class SharedEffects {
 public:
  SharedEffects() = default;
  explicit SharedEffects(const std::vector<SharedEffect>& effects);

  struct Entry {
    std::uint32_t component;
    double per_sd;  ///< [sr^-1]
  };
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  /// Adds `factor` times the other's effects.
  void add(const SharedEffects& other, double factor);
  /// Leaves out effects of a size up to `most`: what a difference of equal ones leaves.
  void drop_up_to(double most);

 private:
  std::vector<Entry> entries_;
};

/// The root sum of squares.
[[nodiscard]] double size_of(const SharedEffects& effects);

}  // namespace gonio::reflectance
