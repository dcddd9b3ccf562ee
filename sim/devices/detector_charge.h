#pragma once

#include "sim/devices/detector_noise.h"
#include "sim/optics/dark_drift.h"
#include "sim/optics/light_path.h"
#include "sim/scene/scene.h"
#include "sim/scene/truth.h"

namespace gonio::sim {

/// From the light of an exposure to what its frame is drawn from: exposure offset, nonlinearity, dark charge and how it
/// drifts. Immutable but for what it refers to; threads: any.
class DetectorCharge {
 public:
  /// Both must outlive it.
  DetectorCharge(const Scene& scene, const Truth& truth) : scene_(scene), truth_(truth), drift_(scene) {}

  /// The exposure's electrons and its offset; its number, times, gain and place are the caller's. `light` is the
  /// integral over the stated exposure of `length_s` > 0 of scene time from `from_s` on, `lamp` the lamp's mean over
  /// it.
  [[nodiscard]] Exposure collect(const LightRate& light, double lamp, double from_s, double length_s) const;
  [[nodiscard]] const DarkDrift& drift() const { return drift_; }

 private:
  [[nodiscard]] double signal(double electrons) const;

  const Scene& scene_;
  const Truth& truth_;
  DarkDrift drift_;
};

}  // namespace gonio::sim
