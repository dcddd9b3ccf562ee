#pragma once

#include "base/units.h"

namespace gonio::drivers {

/// The head of an arm: a capsule whose axis lies along the arm's ray from the sample, between two distances from it.
struct ArmHead {
  Length nearest;
  Length farthest;
  Length radius;
};

/// What must not meet: source head and detector head, each on its ray from the sample. Immutable.
class KeepOut {
 public:
  /// `margin` is kept between the surfaces. Distances are positive, nearest <= farthest.
  KeepOut(const ArmHead& source, const ArmHead& detector, Length margin);

  /// Between the surfaces of the heads at this angle between the arms; negative where they overlap. Grows with the
  /// angle. Distance of the axes: the least (s - t)^2 + 4 s t sin^2(xi/2) over points at s and t of the two rays.
  [[nodiscard]] Length clearance(Angle separation) const;

  /// The angle from which on the margin is kept; 0 when the heads pass each other at any angle; 180 deg when they never
  /// keep it.
  [[nodiscard]] Angle least_separation() const { return least_; }

 private:
  ArmHead source_;
  ArmHead detector_;
  Angle least_;
};

}  // namespace gonio::drivers
