#pragma once

#include <cstdint>

#include "protocol/stage/axis.h"
#include "sim/scene/scene.h"
#include "sim/scene/truth.h"

namespace gonio::sim {

/// Where everything in the light's way stands at one instant: positions as the axes are (deg, mm, slot), without the
/// errors that only the truth knows.
struct StagePose {
  stage::PerAxis<double> positions{};
  stage::PerAxis<std::uint64_t> last_moves{};  ///< which move brought each axis there
  std::uint64_t last_move = 0;                 ///< of any axis
  bool source_open = false;
  bool detector_open = false;
};

/// What stands before the detector.
enum class Station : std::uint8_t { Between, Sample, Reference, Trap };

/// From the lamp to the detector: the field of view lies inside the lit spot, so the signal goes as f_r cos(theta_i)
/// (Mobley 2005, footnote 5) at the true angles. Immutable but for what it refers to; threads: any.
class LightPath {
 public:
  /// Both must outlive it.
  LightPath(const Scene& scene, const Truth& truth) : scene_(scene), truth_(truth) {}

  /// Electrons per second of scene time in one lit pixel, for lamp output 1, before nonlinearity. 0 with a closed
  /// shutter, between carriage stations, between filters, before the black trap, with the lamp below the horizon.
  [[nodiscard]] double electron_rate(const StagePose& pose) const;

  [[nodiscard]] Station station(double carriage_mm) const;
  /// The encoders' directions with the zero and repeat errors of the truth.
  [[nodiscard]] Geometry true_geometry(const StagePose& pose) const;
  /// The filter that stands in the light at this position of the wheel; null between filters.
  [[nodiscard]] const FilterSpec* filter_at(double slot) const;

 private:
  const Scene& scene_;
  const Truth& truth_;
};

}  // namespace gonio::sim
